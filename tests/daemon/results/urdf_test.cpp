#include <algorithm>
#include <charconv>
#include <random>

#include <pugixml.hpp>

#include "daemon/results/models.hpp"
#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/chain_outcomes.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

Vector3d three(const pugi::xml_attribute& attribute) {
  const std::string_view text = attribute.value();
  Vector3d v;
  const char* at = text.data();
  for (Eigen::Index k = 0; k < 3; ++k) {
    while (*at == ' ') ++at;
    const auto [end, error] = std::from_chars(at, text.data() + text.size(), v(k));
    REQUIRE(error == std::errc());
    at = end;
  }
  REQUIRE(at == text.data() + text.size());
  return v;
}

struct Document {
  explicit Document(const Outcome& outcome) {
    const auto models = models_of(outcome);
    REQUIRE_FALSE(models.empty());
    text = urdf(models.back(), outcome);
    REQUIRE(xml.load_string(text.c_str()));
  }
  [[nodiscard]] pugi::xml_node joint(const char* name) const {
    return xml.child("robot").find_child_by_attribute("joint", "name", name);
  }

  std::string text;
  pugi::xml_document xml;
};

/// From base_link along the parents to tool0, as any reader of URDF computes it; mm.
Isometry3d kinematics(const Document& document, const std::vector<double>& values) {
  Isometry3d pose = Isometry3d::Identity();
  std::string link = "base_link";
  std::size_t moving = 0;
  while (link != "tool0") {
    pugi::xml_node joint;
    for (const auto& candidate : document.xml.child("robot").children("joint"))
      if (link == candidate.child("parent").attribute("link").value()) joint = candidate;
    REQUIRE(joint);
    const Vector3d xyz = three(joint.child("origin").attribute("xyz"));
    const Vector3d rpy = three(joint.child("origin").attribute("rpy"));
    pose = pose * Eigen::Translation3d(1000 * xyz) * AngleAxisd(rpy.z(), Vector3d::UnitZ()) *
           AngleAxisd(rpy.y(), Vector3d::UnitY()) * AngleAxisd(rpy.x(), Vector3d::UnitX());
    if (joint.attribute("type").value() != std::string("fixed"))
      pose = pose * AngleAxisd(values.at(moving++), three(joint.child("axis").attribute("xyz")));
    link = joint.child("child").attribute("link").value();
  }
  CHECK(moving == values.size());
  return pose;
}

}  // namespace

TEST_CASE("a URDF read back moves by the controller's angles as the chain, to 1e-9 m", "[urdf]") {
  const Outcome outcome = chain_outcome();
  const Document document(outcome);
  std::mt19937 random(12);
  double worst_mm = 0;
  double worst_rotation = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto turns = random_turns(random);
    std::vector<double> values;
    for (std::size_t j = 0; j < 6; ++j)
      values.push_back(*outcome.identification.home_rad[j] + turns[j]);
    const auto pose = kinematics(document, values);
    worst_mm = std::max(worst_mm, misfit_mm(outcome, turns, pose));
    worst_rotation = std::max(worst_rotation, misfit_of_rotation(outcome, turns, pose));
  }
  CHECK(worst_mm < 1e-6);
  CHECK(worst_rotation < 1e-12);
}

TEST_CASE("joint values of a URDF count from home where home is not known", "[urdf]") {
  Outcome outcome = chain_outcome();
  outcome.identification.home_rad[2].reset();
  outcome.limits.assign(6, {-100, 100});
  const Document document(outcome);
  REQUIRE(document.joint("joint_3_from_home"));
  CHECK(document.joint("joint_3_from_home").attribute("type").value() == std::string("continuous"));
  std::mt19937 random(13);
  const auto turns = random_turns(random);
  std::vector<double> values;
  for (std::size_t j = 0; j < 6; ++j)
    values.push_back(outcome.identification.home_rad[j].value_or(0) + turns[j]);
  CHECK(misfit_mm(outcome, turns, kinematics(document, values)) < 1e-6);
}

TEST_CASE("joints of a URDF have the limits of the description, or are continuous", "[urdf]") {
  Outcome outcome = chain_outcome();
  CHECK(Document(outcome).joint("joint_1").attribute("type").value() == std::string("continuous"));
  outcome.limits.assign(6, {-155, 155});
  outcome.limits[0].max_speed_deg_s = 154;
  outcome.limits[4] = {};
  outcome.limits[4].max_speed_deg_s = 384;
  outcome.limits[5] = {};
  const Document document(outcome);
  const auto limit = document.joint("joint_1").child("limit");
  CHECK(document.joint("joint_1").attribute("type").value() == std::string("revolute"));
  CHECK(limit.attribute("lower").as_double() == Approx(-155 * kPi / 180));
  CHECK(limit.attribute("upper").as_double() == Approx(155 * kPi / 180));
  CHECK(limit.attribute("effort"));
  CHECK(limit.attribute("velocity").as_double() == Approx(154 * kPi / 180));
  CHECK(document.joint("joint_2").child("limit").attribute("velocity").as_double() == 0);
  CHECK(document.joint("joint_5").attribute("type").value() == std::string("continuous"));
  CHECK(document.joint("joint_5").child("limit").attribute("velocity").as_double() ==
        Approx(384 * kPi / 180));
  CHECK(document.joint("joint_6").attribute("type").value() == std::string("continuous"));
  CHECK_FALSE(document.joint("joint_6").child("limit"));
}

TEST_CASE("a URDF is well-formed whatever the robot's name, and has no calibration tags",
          "[urdf]") {
  Outcome outcome = chain_outcome();
  outcome.robot = "a<b>&\"c\"\xff\n";
  const Document document(outcome);
  CHECK(document.xml.child("robot").attribute("name").value() == std::string("a<b>&\"c\"__"));
  CHECK(document.text.find("calibration") == std::string::npos);
  int links = 0;
  for ([[maybe_unused]] const auto& link : document.xml.child("robot").children("link")) ++links;
  CHECK(links == 8);
}
