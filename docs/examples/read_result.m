% Reads result.json of sweepd into MATLAB (R2017b or newer) and shows the DH table.
%
%   T = read_result("result.json")
%
% T has a row a joint. NaN stands where the data do not determine a number. Numbers with an
% uncertainty of NaN are set by convention.
function T = read_result(file)
  result = jsondecode(fileread(file));
  assert(startsWith(result.schema, "sweepd.result/"), "no result of sweepd");
  fprintf("%s: %s, describes the %s\n", result.robot, result.status, result.describes);
  rows = result.dh;
  if ~iscell(rows)  % jsondecode makes a struct array where all rows have the same fields
    rows = num2cell(rows);
  end
  names = ["b_mm", "b_sigma_mm", "theta_deg", "theta_sigma_deg", ...
           "a_mm", "a_sigma_mm", "alpha_deg", "alpha_sigma_deg", "beta_deg", "beta_sigma_deg"];
  values = NaN(numel(rows), numel(names));
  for joint = 1:numel(rows)
    for k = 1:numel(names)
      if isfield(rows{joint}, names(k)) && ~isempty(rows{joint}.(names(k)))
        values(joint, k) = rows{joint}.(names(k));
      end
    end
  end
  T = array2table(values, "VariableNames", cellstr(names));
  disp(T);
end
