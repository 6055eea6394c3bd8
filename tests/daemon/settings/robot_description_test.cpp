#include "daemon/settings/robot_description.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include "daemon/settings/toml_table.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using identify::kDegree;
using sweepd::load_robot;
namespace fs = std::filesystem;

namespace {

const fs::path kRobots = fs::path(SWEEPD_SOURCE_DIR) / "config" / "robots";

/// What the makers' drawings say, in mm: see the public models of ros-industrial/kuka_experimental.
struct Model {
  const char* file;
  double d1, a1, a2, a3, d4;
  double last;  ///< from the wrist centre to the last frame
};
constexpr Model kModels[] = {
    {"kr5_arc", 400, 180, 600, 120, 620, 0},  // its last frame is the wrist centre, as in the paper
    {"kr3_r540", 345, 20, 260, 20, 260, 75},
    {"kr6_r700_sixx", 400, 25, 315, 35, 365, 80},
    {"kr6_r900_sixx", 400, 25, 455, 35, 420, 80},
    {"kr6_r900_2", 400, 25, 455, 25, 420, 90},
    {"kr10_r1100_sixx", 400, 25, 560, 35, 515, 80},
    {"kr10_r1420", 450, 150, 610, 20, 660, 80},
    {"kr16_2", 675, 260, 680, -35, 670, 158},
    {"kr120_r2500_pro", 675, 350, 1150, -41, 1000, 215},
    {"kr150_2", 750, 350, 1250, -55, 1100, 230},
    {"kr150_r3100_2", 645, 330, 1350, 115, 1420, 215},
};

/// Pose of the last frame without any DH table: the axes as lines in the pose (0, -90, 90, 0, 0,
/// 0), about which the arm turns out of that pose, the outermost joint first.
Isometry3d pose_from_axes(const Model& m, const std::vector<double>& angles_rad) {
  const double shoulder = m.d1, elbow = m.d1 + m.a2, forearm = m.d1 + m.a2 + m.a3;
  const double wrist = m.a1 + m.d4;
  struct Axis {
    Vector3d direction, point;
    double angle_deg;  ///< in that pose
  };
  const std::array<Axis, 6> axes{{{-Vector3d::UnitZ(), {0, 0, 0}, 0},
                                  {Vector3d::UnitY(), {m.a1, 0, shoulder}, -90},
                                  {Vector3d::UnitY(), {m.a1, 0, elbow}, 90},
                                  {-Vector3d::UnitX(), {0, 0, forearm}, 0},
                                  {Vector3d::UnitY(), {wrist, 0, forearm}, 0},
                                  {-Vector3d::UnitX(), {0, 0, forearm}, 0}}};
  // A KUKA flange reads A = 0, B = 90, C = 0 there: X down, Z forwards.
  Isometry3d pose(Translation3d(wrist + m.last, 0, forearm) *
                  AngleAxisd(90 * kDegree, Vector3d::UnitY()));
  for (std::size_t i = axes.size(); i-- > 0;) {
    const double turned = angles_rad[i] - axes[i].angle_deg * kDegree;
    pose = Translation3d(axes[i].point) * AngleAxisd(turned, axes[i].direction) *
           Translation3d(-axes[i].point) * pose;
  }
  return pose;
}

struct RobotFile {
  sweepd::test::TemporaryFolder folder;
  fs::path path;

  explicit RobotFile(const std::string& text) : path(folder.write("robot.toml", text)) {}
};

/// The error without the file's name; "no error" if the description is fine.
std::string robot_error(const std::string& text) {
  const RobotFile file(text);
  try {
    (void)load_robot(file.path);
  } catch (const sweepd::ConfigError& error) {
    return std::string(error.what()).substr(file.path.string().size() + 1);
  }
  return "no error";
}

const std::string kRow = "b_mm = 1\ntheta_deg = 90\na_mm = 2\nalpha_deg = -90\npositive = 1\n";

}  // namespace

TEST_CASE("a home or tool beyond any robot is told where it stands",
          "[robot_description][issue11][point_14]") {
  const std::string joint = "[[joint]]\n" + kRow;
  CHECK(robot_error("name = \"x\"\nhome_deg = [1e300]\n" + joint) ==
        "2:13: home_deg: expected a number of degrees from -1e+05 to 1e+05, found the number "
        "1e+300: choose one in between");
  CHECK_THAT(robot_error("name = \"x\"\nhome_deg = [0]\ntool_mm = [0, -1e6, 0]\n" + joint),
             Catch::Matchers::StartsWith("3:15: tool_mm: expected a number of millimetres from"));
}

TEST_CASE("every shipped robot moves as its axes say", "[robot_description]") {
  constexpr unsigned kSeed = 20130704;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> angle(-180 * kDegree, 180 * kDegree);
  for (const Model& model : kModels) {
    INFO(model.file << ", seed " << kSeed);
    const auto robot = load_robot(kRobots / (std::string(model.file) + ".toml"));
    REQUIRE(robot.arm);
    REQUIRE(robot.joints() == 6);
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<double> angles_rad(6);
      for (double& a : angles_rad) a = angle(random);
      const Isometry3d from_rows = forward_kinematics(*robot.arm, angles_rad);
      const Isometry3d from_axes = pose_from_axes(model, angles_rad);
      // Rounding of some thirty products of lengths up to 3 m: 1e-9 mm leaves a factor of 100.
      CHECK((from_rows.translation() - from_axes.translation()).norm() < 1e-9);
      CHECK((from_rows.linear() - from_axes.linear()).norm() < 1e-13);
    }
  }
}

TEST_CASE("every file of the robots' folder is one of the models that are verified",
          "[robot_description]") {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kRobots)) {
    ++files;
    CHECK(std::any_of(std::begin(kModels), std::end(kModels), [&](const Model& model) {
      return entry.path().filename() == std::string(model.file) + ".toml";
    }));
    CHECK_FALSE(load_robot(entry.path()).source.empty());
  }
  CHECK(files == std::size(kModels));
}

TEST_CASE("the target point of every shipped robot is well off axis 6", "[robot_description]") {
  for (const Model& model : kModels) {
    INFO(model.file);
    const auto robot = load_robot(kRobots / (std::string(model.file) + ".toml"));
    CHECK(robot.arm->tool_mm.head<2>().norm() >= 200);
  }
}

TEST_CASE("the KR 5 arc has the table and the home of the paper", "[robot_description]") {
  const auto robot = load_robot(kRobots / "kr5_arc.toml");
  CHECK(robot.name == "KR 5 arc");
  CHECK(robot.home_deg == std::vector<double>{90, -90, 90, 0, 90, 0});
  const double b[] = {400, 0, 0, 620, 0, 0}, a[] = {180, 600, 120, 0, 0, 0};
  const double alpha_deg[] = {90, 0, 90, 90, 90, 0};
  const double min_deg[] = {-155, -180, -15, -350, -130, -350};
  const double max_deg[] = {155, 65, 158, 350, 130, 350};
  const double max_speed_deg_s[] = {154, 154, 228, 343, 384, 721};
  for (std::size_t i = 0; i < 6; ++i) {
    INFO("joint " << i + 1);
    CHECK(robot.arm->rows[i].b_mm == b[i]);
    CHECK(robot.arm->rows[i].a_mm == a[i]);
    CHECK(robot.arm->rows[i].alpha_rad == Approx(alpha_deg[i] * kDegree).margin(1e-15));
    CHECK(robot.arm->positive[i] == -1);
    CHECK(robot.arm->home_rad[i] == Approx(robot.home_deg[i] * kDegree).margin(1e-15));
    CHECK(robot.limits[i].min_deg == min_deg[i]);
    CHECK(robot.limits[i].max_deg == max_deg[i]);
    CHECK(robot.limits[i].max_speed_deg_s == max_speed_deg_s[i]);
  }
  CHECK(robot.arm->tool_mm == Vector3d(200, 0, 215));
}

TEST_CASE("a robot may have no specified table, no home and no limits", "[robot_description]") {
  const RobotFile file(
      "name = \"x\"\n[[joint]]\n[[joint]]\nmin_deg = -10\nmax_deg = 20\n"
      "max_speed_deg_s = 90\n");
  const auto robot = load_robot(file.path);
  CHECK(robot.joints() == 2);
  CHECK_FALSE(robot.arm);
  CHECK(robot.home_deg.empty());
  CHECK(robot.source.empty());
  CHECK(robot.limits[0].contain(1e9));
  CHECK(robot.limits[1].contain(20));
  CHECK_FALSE(robot.limits[1].contain(20.1));
  CHECK_FALSE(robot.limits[1].contain(-10.1));
  CHECK(robot.limits[0].max_speed_deg_s == std::numeric_limits<double>::infinity());
  CHECK(robot.limits[1].max_speed_deg_s == 90);
}

TEST_CASE("what joints give way by may be described, a joint at a time", "[robot_description]") {
  const RobotFile file(
      "name = \"x\"\n[[joint]]\n[[joint]]\nsag_arcsec = 60.0\n[[joint]]\nsag_arcsec = 30\n");
  CHECK(load_robot(file.path).sag_arcsec == std::vector<double>{0, 60, 30});
  CHECK_THAT(robot_error("name = \"x\"\n[[joint]]\nsag_arcsec = -1\n"),
             Catch::Matchers::StartsWith("3:14: joint.sag_arcsec: expected a number of arcseconds "
                                         "from 0 to 3600"));
}

TEST_CASE("an arm of one joint or of twelve is read, and one of thirteen is refused",
          "[robot_description]") {
  const auto arm = [](int joints) {
    std::string text = "name = \"x\"\nhome_deg = [0";
    for (int i = 1; i < joints; ++i) text += ", 0";
    text += "]\n";
    for (int i = 0; i < joints; ++i) text += "[[joint]]\n" + kRow;
    return text;
  };
  CHECK(robot_error(arm(1)) == "no error");
  CHECK(robot_error(arm(12)) == "no error");
  CHECK_THAT(robot_error(arm(13)),
             Catch::Matchers::ContainsSubstring("expected 1 to 12 joints, found 13"));
  CHECK_THAT(robot_error("name = \"x\"\n"),
             Catch::Matchers::ContainsSubstring("at least one table [[joint]]"));
}

TEST_CASE("a table is given for all joints or for none", "[robot_description]") {
  const std::string head = "name = \"x\"\nhome_deg = [0, 0]\n";
  CHECK_THAT(robot_error(head + "[[joint]]\n" + kRow + "[[joint]]\nmin_deg = 0\nmax_deg = 1\n"),
             Catch::Matchers::StartsWith(
                 "9:1: joint.b_mm: missing: expected b_mm, theta_deg, a_mm, alpha_deg "
                 "and positive in every [[joint]], or in none"));
  CHECK_THAT(robot_error(head + "[[joint]]\na_mm = 5\n[[joint]]\n"),
             Catch::Matchers::StartsWith("3:1: joint.b_mm: missing"));
  CHECK_THAT(robot_error(head + "tool_mm = [1, 2, 3]\n[[joint]]\n[[joint]]\n"),
             Catch::Matchers::StartsWith("3:11: tool_mm: expected no tool point"));
  CHECK_THAT(robot_error(head + "up = [1, 0, 0]\n[[joint]]\n[[joint]]\n"),
             Catch::Matchers::StartsWith("3:6: up: expected no direction in the base"));
  CHECK_THAT(robot_error("name = \"x\"\n[[joint]]\n" + kRow),
             Catch::Matchers::ContainsSubstring(
                 "home_deg: missing: expected an array of numbers of degrees"));
}

TEST_CASE("a table in metres or in radians is refused, and short parts of an arm are none",
          "[robot_description]") {
  const auto row = [](const std::string& b, const std::string& a, const std::string& alpha) {
    return "[[joint]]\nb_mm = " + b + "\ntheta_deg = 0\na_mm = " + a + "\nalpha_deg = " + alpha +
           "\npositive = 1\n";
  };
  const std::string head = "name = \"x\"\nhome_deg = [0, 0, 0]\n";
  CHECK_THAT(
      robot_error(head + row("0.4", "0.18", "90") + row("0", "0.6", "0") + row("0", "0", "0")),
      Catch::Matchers::StartsWith("12:8: joint.a_mm: expected mm, found the number 0.6 as the "
                                  "greatest length of the table, which looks like metres"));
  CHECK_THAT(
      robot_error(head + row("400", "180", "90") + row("0", "600", "0") + row("0", "0", "-1.5708")),
      Catch::Matchers::StartsWith("19:13: joint.alpha_deg: expected degrees, found the number "
                                  "-1.5708, 90 degrees in radians: write -90"));
  CHECK_THAT(
      robot_error(head + row("400", "180", "3.14159") + row("0", "0", "0") + row("0", "0", "0")),
      Catch::Matchers::ContainsSubstring("180 degrees in radians: write 180"));
  // A joint that pans and tilts, as built.
  CHECK(robot_error(head + row("3.1", "0", "90") + row("0", "-0.8", "-90") + row("0", "0", "0")) ==
        "no error");
}

TEST_CASE("a wrong figure of a robot is found in its line", "[robot_description]") {
  const std::string head = "name = \"x\"\nhome_deg = [5]\n";
  const std::string robot = head + "[[joint]]\n" + kRow;
  CHECK_THAT(robot_error("home_deg = [5]\n[[sweep]]\njoint = 1\n"),
             Catch::Matchers::StartsWith(
                 "2:1: sweep: expected a robot description, found a plan of sweeps: "));
  CHECK(robot_error(robot + "max_dge = 1\n") ==
        "9:1: joint.max_dge: unknown key: did you mean \"max_deg\"?");
  CHECK(robot_error(robot + "min_deg = 1\n") ==
        "3:1: joint.max_deg: missing: expected a number of degrees: add it to this table");
  CHECK_THAT(robot_error(robot + "min_deg = 7\nmax_deg = 7\n"),
             Catch::Matchers::StartsWith("10:11: joint.max_deg: expected more than min_deg = 7"));
  CHECK_THAT(robot_error(robot + "max_speed_deg_s = 0\n"),
             Catch::Matchers::StartsWith("9:19: joint.max_speed_deg_s: expected a number of "
                                         "degrees per second from 0.1 to 10000"));
  CHECK_THAT(robot_error(robot + "min_deg = 6\nmax_deg = 7\n"),
             Catch::Matchers::StartsWith("2:12: home_deg: expected joint 1 from 6 to 7, found 5"));
  CHECK_THAT(
      robot_error("tool_mm = [1, 2]\n" + robot),
      Catch::Matchers::StartsWith("1:11: tool_mm: expected [x, y, z], found an array of 2 values"));
  CHECK_THAT(robot_error("up = [0, 0, 0]\n" + robot),
             Catch::Matchers::StartsWith("1:6: up: expected a direction, found "));
  CHECK_THAT(robot_error("name = \"x\"\nhome_deg = [5, 6]\n[[joint]]\n" + kRow),
             Catch::Matchers::ContainsSubstring(
                 "expected 1 angles, one a [[joint]], found an array of 2 values"));
  CHECK_THAT(robot_error(head + "[[joint]]\nb_mm = 0\ntheta_deg = 0\na_mm = 0\nalpha_deg = 0\n"
                                "positive = 0\n"),
             Catch::Matchers::ContainsSubstring("joint.positive: expected 1 or -1"));
  CHECK_THAT(
      robot_error(head + "[[joint]]\nb_mm = 0\ntheta_deg = 0\na_mm = 0\nalpha_deg = 0\n"
                         "positive = 2\n"),
      Catch::Matchers::ContainsSubstring("joint.positive: expected 1 or -1, found the number 2"));
}
