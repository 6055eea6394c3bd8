#include "daemon/report/report_folder.hpp"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "daemon/report/file_parts.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::filesystem::path& file) {
  const auto text = rsi::readable_bytes(file);
  Json json = text ? Json::parse(*text, nullptr, false) : Json();
  return json.is_object() ? json : Json();
}

struct Columns {
  explicit Columns(const Cells& head)
      : joint(head.find("joint")),
        sweep(head.find("sweep")),
        target(head.find("target")),
        time(head.find("t_s")),
        position{head.find("x_mm"), head.find("y_mm"), head.find("z_mm")},
        plane(head.find("plane_residual_mm")),
        radial(head.find("radial_residual_mm")),
        chain_axial(head.find("chain_axial_residual_mm")),
        chain_radial(head.find("chain_radial_residual_mm")),
        error(head.find("angle_error_arcsec")),
        curve(head.find("curve_error_arcsec")) {
    for (std::size_t j = 0;; ++j) {
      const auto name = "a" + std::to_string(j + 1);
      auto at = head.find(name + "_deg");
      if (head[at].empty()) at = head.find(name + "_mm");
      if (head[at].empty()) break;
      angles.push_back(at);
    }
  }
  std::size_t joint, sweep, target, time;
  std::array<std::size_t, 3> position;
  std::size_t plane, radial, chain_axial, chain_radial, error, curve;
  std::vector<std::size_t> angles;
};

void add(PointSums& sums, const Eigen::Vector3d& position) {
  if (sums.count++ == 0) sums.origin = position;
  const Eigen::Vector3d from = position - sums.origin;
  sums.sum += from;
  sums.products += from * from.transpose();
}

/// From the chain where it has one, else from the circle.
double either(double chain, double circle) {
  return chain == chain ? chain : circle;
}

}  // namespace

void MeanSquare::add(double value) {
  if (!std::isfinite(value)) return;
  ++count;
  squares += value * value;
}

double MeanSquare::root() const {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

void read_strokes(std::string_view text, ReportFolder& folder) {
  Cells cells;
  cells.split(take_line(text));
  const Columns at(cells);
  // A first look: which stroke each row is of, and how many rows each stroke has.
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::size_t> places;
  std::vector<std::size_t> rows;
  std::vector<std::size_t> strokes;
  const auto stroke_of = [&]() -> std::size_t {
    const auto index = [&](std::size_t column) {
      const double value = value_in(cells[column]);
      return value >= 1 && value < 1e9 ? static_cast<std::size_t>(value) - 1 : 0;
    };
    const auto key = std::tuple(index(at.joint), index(at.sweep), index(at.target));
    const auto [place, is_new] = places.try_emplace(key, folder.strokes.size());
    if (is_new) {
      folder.strokes.push_back({std::get<0>(key), std::get<1>(key), std::get<2>(key), {}});
      rows.push_back(0);
    }
    return place->second;
  };
  for (auto rest = text; !rest.empty();) {
    cells.split(take_line(rest));
    strokes.push_back(stroke_of());
    ++rows[strokes.back()];
  }
  std::vector<std::size_t> seen(rows.size(), 0);
  std::map<std::size_t, std::size_t> of_joint;
  for (std::size_t s = 0; s < rows.size(); ++s) of_joint[folder.strokes[s].joint] += rows[s];
  for (const std::size_t s : strokes) {
    cells.split(take_line(text));
    Stroke& stroke = folder.strokes[s];
    const Eigen::Vector3d position(value_in(cells[at.position[0]]), value_in(cells[at.position[1]]),
                                   value_in(cells[at.position[2]]));
    const std::size_t row = seen[s]++;
    if (!position.allFinite()) continue;
    if (folder.sums.size() <= stroke.joint && stroke.joint < 64)
      folder.sums.resize(stroke.joint + 1);
    if (stroke.joint < folder.sums.size()) {
      PointSums& sums = folder.sums[stroke.joint];
      if (!sums.target) sums.target = stroke.target;
      if (sums.target == stroke.target) add(sums, position);
    }
    const double axial = either(value_in(cells[at.chain_axial]), value_in(cells[at.plane]));
    const double radial = either(value_in(cells[at.chain_radial]), value_in(cells[at.radial]));
    const double along = value_in(cells[at.error]);
    if (stroke.joint < folder.sums.size()) {
      folder.sums[stroke.joint].axial_mm.add(axial);
      folder.sums[stroke.joint].radial_mm.add(radial);
      folder.sums[stroke.joint].along_arcsec.add(along);
    }
    // Evenly spread, the first and the last row among them.
    const std::size_t step =
        (of_joint[stroke.joint] + ReportFolder::kMostPoints - 1) / ReportFolder::kMostPoints;
    if (row % step != 0 && row + 1 != rows[s]) continue;
    stroke.points.push_back(
        {position, value_in(cells[at.time]),
         stroke.joint < at.angles.size() ? value_in(cells[at.angles[stroke.joint]]) : kNothing,
         axial, radial, along, value_in(cells[at.curve])});
  }
}

void require_result(const nlohmann::ordered_json& json, const std::filesystem::path& file) {
  const std::string schema = text_of(json, "schema");
  if (schema == schemas::kResult) return;
  throw std::runtime_error(
      file.string() +
      (schema.starts_with("sweepd.result/")
           ? " has the schema " + schema + ", and this sweepd reads " + schemas::kResult +
                 ": use the sweepd that wrote it"
           : " holds no result of sweepd: give a folder that run, replay or identify has "
             "written, or its result.json"));
}

ReportFolder read_report_folder(const std::filesystem::path& path) {
  ReportFolder folder;
  const auto named = [&](const char* name) { return folder.files.emplace_back(path / name); };
  const auto file = named(file_names::kResult);
  folder.result = json_of(file);
  if (!std::filesystem::exists(file))
    throw std::runtime_error(
        file.string() + " is not there: give a folder that run, replay or identify has written");
  require_result(folder.result, file);
  folder.run = json_of(named(file_names::kRun));
  folder.link = json_of(named(file_names::kLink));
  folder.dh_csv = rsi::readable_bytes(named(file_names::kTable)).value_or("");
  folder.currents_csv = rsi::readable_bytes(named(file_names::kCurrents)).value_or("");
  folder.displacement_csv = rsi::readable_bytes(named(file_names::kDisplacement)).value_or("");
  folder.name = std::filesystem::weakly_canonical(path).filename().string();
  read_strokes(rsi::readable_bytes(named(file_names::kSweeps)).value_or(""), folder);
  return folder;
}

}  // namespace sweepd
