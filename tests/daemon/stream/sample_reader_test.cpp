#include "daemon/stream/sample_reader.hpp"

#include <random>

#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"

using sweepd::radians;
using sweepd::SampleReader;
using sweepd::SignalNames;
using sweepd::test::telegram;

namespace {

/// Keeps the text that the parsed telegram points into.
class Parsed {
 public:
  explicit Parsed(std::string_view elements) : text_(telegram(4000, elements)) {
    REQUIRE(telegram_.parse(text_) == rsi::Defect::none);
  }
  operator const rsi::Telegram&() const { return telegram_; }

 private:
  std::string text_;
  rsi::Telegram telegram_;
};

/// The row of the telegram last read.
std::string csv(const SampleReader& reader) {
  std::string row;
  reader.append_csv(row);
  return row;
}

const std::string kPosition = R"(<RIst X="1.5" Y="-2.25" Z="3.125" A="10.0" B="-20.0" C="30.0"/>)";
const std::string kAngles = R"(<AIPos A1="1.0" A2="-90.0" A3="90.0" A4="4.0" A5="5.0" A6="6.0"/>)";

}  // namespace

TEST_CASE("position, orientation and angles are taken from where RSI puts them",
          "[sample_reader]") {
  SampleReader reader(SignalNames{}, 6);
  const auto sample = reader.read(Parsed(kPosition + kAngles));
  REQUIRE(sample.has_position);
  CHECK(sample.position_mm == Eigen::Vector3d(1.5, -2.25, 3.125));
  REQUIRE(sample.has_orientation);
  CHECK(sample.abc_rad == std::array{radians(10.0), radians(-20.0), radians(30.0)});
  REQUIRE(sample.joints == 6);
  CHECK(sample.angles_rad[1] == radians(-90.0));
  CHECK(sample.angles_rad[5] == radians(6.0));
  CHECK(reader.unusable() == 0);
}

TEST_CASE("a sample tells whether an external axis stands elsewhere, not that it trembles",
          "[sample_reader]") {
  const auto once = [](SampleReader& reader, const std::string& e1) {
    return reader.read(Parsed("<EIPos E1=\"" + e1 + R"(" E2="5.0" E3="0" E4="0" E5="0" E6="0"/>)"))
        .external_place;
  };
  const auto place = [&](SampleReader& reader, const std::string& e1) {
    for (int telegrams = 1; telegrams < 12; ++telegrams) once(reader, e1);
    return once(reader, e1);
  };
  SampleReader reader(SignalNames{}, 6);
  const auto before = place(reader, "100.0");
  CHECK(place(reader, "100.1") == before);
  CHECK(place(reader, "99.9") == before);
  const auto after = place(reader, "101.0");
  CHECK(after != before);
  CHECK(place(reader, "101.1") == after);
  CHECK(reader.read(Parsed(kPosition)).external_place == after);  // not told
  SECTION("back where it stood it is known again, however far it went") {
    for (int mm = 102; mm < 600; ++mm) CHECK(once(reader, std::to_string(mm)) != before);
    for (int mm = 600; mm > 101; --mm) once(reader, std::to_string(mm));
    CHECK(place(reader, "100.1") == before);
  }
  SECTION("it has not moved for the sake of a telegram that is off") {
    for (const char* off : {"100.0", "0.0", "1e9"}) {
      CHECK(once(reader, off) == after);
      for (int telegrams = 0; telegrams < 12; ++telegrams) CHECK(once(reader, "101.0") == after);
    }
  }
  SECTION("it is seen to have moved within 24 ms, and to go on moving") {
    for (int telegrams = 0; telegrams < 5; ++telegrams) once(reader, "103.0");
    const auto there = once(reader, "103.0");
    CHECK(there != after);
    for (int mm = 0; mm < 9; ++mm) once(reader, std::to_string(104 + mm));
    CHECK(once(reader, "113.0") != there);
  }
  SECTION("one that is a joint of the arm is none") {
    SignalNames names;
    names.angles.push_back("EIPos.E1");
    SampleReader seven(names, 7);
    CHECK(place(seven, "1.0") == place(seven, "50.0"));
  }
}

TEST_CASE("an external axis is seen to move where the telegrams have no others",
          "[sample_reader]") {
  const auto place = [](SampleReader& reader, const std::string& axis) {
    std::uint16_t at = 0;
    for (int telegrams = 0; telegrams < 12; ++telegrams)
      at = reader.read(Parsed("<EIPos " + axis + "/>")).external_place;
    return at;
  };
  SampleReader reader(SignalNames{}, 6);
  const auto before = place(reader, "E1=\"100.0\"");
  CHECK(place(reader, "E1=\"100.1\"") == before);
  CHECK(place(reader, "E1=\"900.0\"") != before);
  CHECK(place(reader, "E1=\"100.0\"") == before);
}

TEST_CASE("external axes that shake about a place have not moved", "[sample_reader]") {
  const double sigma = GENERATE(0.05, 0.1);
  std::mt19937 random(1);
  std::normal_distribution<> shake(0, sigma);
  const auto reading = [&](double e1) {
    std::string text = "<EIPos";
    for (int axis = 1; axis <= 6; ++axis)
      text += " E" + std::to_string(axis) + "=\"" +
              std::to_string((axis == 1 ? e1 : 0) + shake(random)) + "\"";
    return text + "/>";
  };
  SampleReader reader(SignalNames{}, 6);
  for (int telegrams = 0; telegrams < 50; ++telegrams)
    static_cast<void>(reader.read(Parsed(reading(1000))));
  const auto before = reader.read(Parsed(reading(1000))).external_place;
  int elsewhere = 0;
  for (int telegrams = 0; telegrams < 5000; ++telegrams)
    if (reader.read(Parsed(reading(1000))).external_place != before) ++elsewhere;
  CHECK(elsewhere == 0);
  for (int telegrams = 0; telegrams < 12; ++telegrams)
    static_cast<void>(reader.read(Parsed(reading(1001))));
  CHECK(reader.read(Parsed(reading(1001))).external_place != before);
}

TEST_CASE("commanded values are never taken for measured ones", "[sample_reader]") {
  SampleReader reader(SignalNames{}, 6);
  const auto sample = reader.read(
      Parsed(R"(<RSol X="1" Y="2" Z="3" A="0" B="0" C="0"/><ASPos A1="1" A2="2" A3="3" A4="4" )"
             R"(A5="5" A6="6"/>)"));
  CHECK_FALSE(sample.has_position);
  CHECK_FALSE(sample.has_orientation);
  CHECK(sample.joints == 0);
}

TEST_CASE("signals under the user's own names: the text of an element, or an attribute",
          "[sample_reader]") {
  SignalNames names;
  names.position = {"Act_X", "Act_Y", "Act_Z"};
  names.orientation = {"Pos.A", "Pos.B", "Pos.C"};
  names.angles = {"Pos.A1", "Pos.A2"};
  SampleReader reader(names, 6);
  const Parsed parsed(R"(<Act_X>1.5</Act_X><Pos A1="7.0" A2="8.0" A="1.0" B="2.0" C="3.0"/>)"
                      R"(<Act_Y> 2.5 </Act_Y><Act_Z>3.5</Act_Z>)");
  const auto sample = reader.read(parsed);
  REQUIRE(sample.has_position);
  CHECK(sample.position_mm == Eigen::Vector3d(1.5, 2.5, 3.5));
  CHECK(sample.has_orientation);
  REQUIRE(sample.joints == 2);
  CHECK(sample.angles_rad[1] == radians(8.0));
  CHECK(reader.csv_header() == ",x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,a1_deg,a2_deg");
  CHECK(csv(reader) == ",1.5,2.5,3.5,1.0,2.0,3.0,7.0,8.0");
}

TEST_CASE("of a robot with fewer joints than the telegram has angles, the first count",
          "[sample_reader]") {
  SampleReader reader(SignalNames{}, 4);
  CHECK(reader.read(Parsed(kAngles)).joints == 4);
  CHECK(reader.csv_header() == ",x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,a1_deg,a2_deg,a3_deg,a4_deg");
}

TEST_CASE("what is there in part is not there: no coordinate is ever made up", "[sample_reader]") {
  SampleReader reader(SignalNames{}, 6);
  SECTION("a coordinate is missing") {
    const auto sample =
        reader.read(Parsed(R"(<RIst X="1.0" Z="3.0" A="0" B="0" C="0"/>)" + kAngles));
    CHECK_FALSE(sample.has_position);
    CHECK(sample.has_orientation);
    CHECK(sample.joints == 6);
    CHECK(reader.unusable() == 0);
  }
  SECTION("an angle is missing") {
    const auto sample = reader.read(Parsed(kPosition + R"(<AIPos A1="1.0" A2="2.0"/>)"));
    CHECK(sample.has_position);
    CHECK(sample.joints == 0);
  }
  SECTION("a coordinate is no number") {
    for (const char* bad : {"nan", "inf", "1,5", "1.5mm", "", "-", "1e999", "1e13"}) {
      INFO(bad);
      const auto before = reader.unusable();
      const auto sample =
          reader.read(Parsed("<RIst X=\"" + std::string(bad) + "\" Y=\"2.0\" Z=\"3.0\"/>"));
      CHECK_FALSE(sample.has_position);
      CHECK(reader.unusable() == before + 1);
    }
  }
  SECTION("the row keeps its columns, and of what was printed the numbers") {
    const Parsed parsed(R"(<RIst X="1.0" Z="nan"/><AIPos A6="6.50"/>)");
    static_cast<void>(reader.read(parsed));
    CHECK(csv(reader) == ",1.0,,,,,,,,,,,6.50");
  }
}

TEST_CASE("no text of a telegram shifts the columns of samples.csv",
          "[sample_reader][issue11][point_14]") {
  SignalNames names;
  names.position = {"RIst.X", "RIst.Y", "Act_Z"};
  SampleReader reader(names, 6);
  const Parsed parsed(
      "<RIst X=\"1,5\" Y=\"-2\n,3\" A=\"&quot;\" B=\" 4.0 \"/><Act_Z>\n 3.5\n</Act_Z>");
  static_cast<void>(reader.read(parsed));
  CHECK(csv(reader) == ",,,3.5,,4.0,,,,,,,");
  CHECK(reader.unusable() == 3);
}

TEST_CASE("a telegram whose signals stand elsewhere than in the one before is read the same",
          "[sample_reader]") {
  SampleReader reader(SignalNames{}, 6);
  const auto first = reader.read(Parsed(kPosition + kAngles));
  const auto second = reader.read(Parsed("<DiL>0</DiL>" + kAngles + "<Gun X=\"9\"/>" + kPosition));
  CHECK(second.position_mm == first.position_mm);
  CHECK(second.angles_rad == first.angles_rad);
}

TEST_CASE("the resolution is one unit of the last decimal of the finest telegram",
          "[sample_reader]") {
  SampleReader reader(SignalNames{}, 6);
  CHECK(reader.resolution().position_mm == 0);
  CHECK(reader.resolution().angle_rad == 0);
  static_cast<void>(
      reader.read(Parsed(R"(<RIst X="1.5" Y="2.0" Z="0.0" A="0.0" B="0.0" C="0.0"/>)")));
  CHECK(reader.resolution().position_mm == Approx(0.1));
  CHECK(reader.resolution().angle_rad == Approx(radians(0.1)));
  // Some controllers leave trailing zeros out.
  static_cast<void>(reader.read(Parsed(R"(<RIst X="1" Y="2.0625" Z="0"/>)")));
  CHECK(reader.resolution().position_mm == Approx(1e-4));
  CHECK(reader.resolution().angle_rad == Approx(radians(0.1)));
  static_cast<void>(reader.read(Parsed(kPosition)));
  CHECK(reader.resolution().position_mm == Approx(1e-4));
}
