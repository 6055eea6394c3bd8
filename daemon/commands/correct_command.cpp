#include "daemon/commands/correct_command.hpp"

#include <fstream>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/krl/krl_position.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/counted.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

/// No program is larger.
constexpr std::size_t kMostBytes = 64U << 20U;

std::string krl_bytes(const fs::path& file) {
  auto bytes = rsi::file_bytes(file, kMostBytes);
  if (bytes.size() > kMostBytes)
    throw std::runtime_error(file.string() + " is too large for a KRL file: is it another one?");
  return bytes;
}

/// KrlError's findings, each behind the file's name.
template <typename Work>
auto naming(const fs::path& file, const Work& work) {
  try {
    return work();
  } catch (const KrlError& error) {
    std::string text = file.string() + " ";
    for (const char c : std::string_view(error.what())) {
      text += c;
      if (c == '\n') text += file.string() + " ";
    }
    throw std::runtime_error(text);
  }
}

std::optional<Eigen::Isometry3d> frame_of(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  try {
    return krl_frame(text);
  } catch (const KrlError& error) {
    throw std::invalid_argument(option + " " + text + ": " + error.what() +
                                ": write it as \"{X 0,Y 0,Z 115,A 0,B 0,C 0}\"");
  }
}

void check_together(const CorrectOptions& options) {
  const bool targets = options.level == CorrectionLevel::targets;
  if (targets && (!options.program || !options.write))
    throw std::invalid_argument(
        "--level targets corrects the points of a program: give it with --program, and with "
        "--write where the corrected one goes");
  if (!targets && (options.program || options.write || options.config || !options.leave.empty()))
    throw std::invalid_argument(
        "--program, --write, --config and --leave need --level targets: choose it, or leave them "
        "out");
  if (!targets && options.level != CorrectionLevel::frames && !options.tool.empty())
    throw std::invalid_argument(
        "--tool needs --level targets or --level frames: choose one, or leave it out");
}

void check_axes(const Correctable& of) {
  if (of.open.empty()) return;
  std::string joints;
  for (const std::size_t joint : of.open)
    joints += (joints.empty() ? "" : ", ") + std::to_string(joint);
  throw std::runtime_error(of.file.string() + " does not know the axes of all joints (" + joints +
                           " missing): points are corrected by whole results alone. Measure "
                           "poses that move them, with a target off the last axis");
}

CorrectedProgram corrected(const CorrectOptions& options, const Correctable& of,
                           const Correction& correction, const std::string& text) {
  check_axes(of);
  ProgramOptions how;
  how.flange = correction.flange;
  how.base = frame_of("--base", options.base);
  how.tool = frame_of("--tool", options.tool);
  how.largest_shift_mm = options.largest_shift_mm;
  how.limits = of.limits;
  how.measured = of.measured;
  for (const std::string& name : options.leave) how.leave.push_back(in_capitals(name));
  std::string config;
  if (options.config) {
    config = krl_bytes(*options.config);
    how.config = naming(*options.config, [&] { return krl_aggregates(config); });
  }
  return naming(*options.program, [&] {
    return corrected_program(text, of.identified.fit, correction.fit.arm, how);
  });
}

/// Its last line may have no end.
void write_bytes(const fs::path& path, const std::string& bytes) {
  OutputFile file(path);
  std::ofstream out(file.beside(), std::ios::binary | std::ios::trunc);
  out << bytes << std::flush;
  if (!out) throw std::runtime_error("cannot write " + path.string() + ": check the free space");
  out.close();
  file.commit();
}

}  // namespace

CLI::App* add_correct(CLI::App& app, CorrectOptions& options) {
  auto* command = app.add_subcommand(
      "correct",
      "Tell what of a controller, or of a program's points, a measured arm corrects\n"
      "It reads and writes files only, and never moves a robot. It needs a result of static poses "
      "with a robot description.");
  command->add_option("RESULT", options.result, "A folder that identify has written")
      ->required()
      ->type_name("");
  command
      ->add_option_function<std::string>(
          "--level",
          [&options](const std::string& level) {
            for (const auto one : {CorrectionLevel::mastering, CorrectionLevel::frames,
                                   CorrectionLevel::machine_data, CorrectionLevel::targets})
              if (level == text(one)) options.level = one;
          },
          "Correct the joints' zeros, base and tool, machine data (a proposal), or the points of a "
          "program")
      ->required()
      ->type_name("mastering|frames|machine-data|targets")
      ->check(CLI::IsMember({"mastering", "frames", "machine-data", "targets"}));
  auto* program = command
                      ->add_option("--program", options.program,
                                   "Correct the E6POS, POS, E6AXIS and AXIS in this .dat file")
                      ->type_name("P.dat");
  command->add_option("--write", options.write, "Write the corrected program to this file")
      ->type_name("NEW.dat");
  command
      ->add_option("--base", options.base,
                   "Take the points as told in this base, as \"{X 0,Y 0,Z 0,A 0,B 0,C 0}\"")
      ->type_name("FRAME")
      ->needs(program);
  command
      ->add_option("--tool", options.tool,
                   "Take the points as told of this tool. With --level frames, only its A, B, C "
                   "are taken")
      ->type_name("FRAME");
  command
      ->add_option("--config", options.config,
                   "Take base and tool of each point from this $CONFIG.DAT, by the point's FDAT")
      ->type_name("FILE");
  command
      ->add_option("--flange", options.flange,
                   "Say where $FLANGE is in the frame after the last row of the robot description")
      ->type_name("FRAME")
      ->default_str("the same frame");
  add_number(*command, "--largest-shift", options.largest_shift_mm, number_between(0.0, 100.0),
             "Refuse to shift a point by more than so many mm")
      ->needs(program)
      ->type_name("MM");
  command->add_option("--leave", options.leave, "Leave the points of these names as they are")
      ->delimiter(',')
      ->type_name("NAMES");
  command->add_option("--output", options.output, "Write the JSON to this file")
      ->type_name("FILE")
      ->default_str("correction.json in RESULT");
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage}));
  return command;
}

int correct(const CorrectOptions& options, std::ostream& out) {
  check_together(options);
  const Correctable of = read_correctable(options.result);
  const auto json = options.output.value_or(of.file.parent_path() / file_names::kCorrection);
  if (options.write) check_apart("--write and the JSON (--output)", *options.write, json);
  std::vector<fs::path> inputs = {of.file, of.file.parent_path() / file_names::kPoses};
  if (options.program) inputs.push_back(*options.program);
  if (options.config) inputs.push_back(*options.config);
  const Outputs outputs(std::move(inputs), options.force);
  outputs.check_made_again(json, R"({
  "schema": "sweepd.correction/)");
  Correction correction = correction_of(of, options.level);
  if (const auto flange = frame_of("--flange", options.flange)) correction.flange = *flange;
  if (const auto tool = frame_of("--tool", options.tool)) correction.tool = tool->linear();
  if (options.program) {
    correction.program = corrected(options, of, correction, krl_bytes(*options.program));
    outputs.check_same(*options.write, correction.program->text);
    write_bytes(*options.write, correction.program->text);
  }
  write_output(json, correction_json(correction).dump(2) + "\n");
  out << correction_text(correction);
  if (options.write)
    out << "\n"
        << options.write->string() << " is the corrected program. The original is as it was.\n";
  return 0;
}

}  // namespace sweepd
