#include "daemon/krl/krl_data.hpp"

#include "daemon/krl/krl_position.hpp"
#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;

namespace {

// As a controller writes it: CR LF, comments and names in Latin-1, blanks in strings.
constexpr std::string_view kModule =
    "&ACCESS RVP\r\n"
    "&REL 12\r\n"
    "&PARAM EDITMASK = *\r\n"
    "DEFDAT  KLEBEN PUBLIC\r\n"
    ";FOLD EXTERNAL DECLARATIONS;%{PE}%MKUKATPBASIS,%CEXT,%VCOMMON,%P\r\n"
    "; St\xFC"
    "ck {X 1, Y 2} = {nicht lesen\r\n"
    "DECL BASIS_SUGG_T LAST_BASIS={POINT1[] \"P2  {,} \",POINT2[] \"P2\",CP_PARAMS[] "
    "\"CPDAT0\"}\r\n"
    "DECL E6POS XP1={X 814.246033,Y -1.5E-3,Z +620.0,A -180.0,B 0.0,C 180.0,S 2,T 35,E1 0.0,E2 "
    "0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}\r\n"
    "DECL FDAT FP1={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,POINT2[] \" \",TQ_STATE FALSE}\r\n"
    "decl global e6axis xhome = { A1 0.0 , A2 -90 , A3 90.0, A4 0.0,A5 1.0,A6 0.0}\r\n"
    "DECL E6POS XP[3], XQ\r\n"
    "XP[2]={X 1.0,Y 2.0,Z 3.0,A 0.0,B 0.0,C 0.0,S 'B010',T 'H23'}\r\n"
    "XQ={E6POS: X 1.0}\r\n"
    "INT COUNT=3\r\n"
    "ENDDAT\r\n";

}  // namespace

TEST_CASE("Aggregates of a module are read with type, name and line", "[krl_data]") {
  const auto all = krl_aggregates(kModule);
  REQUIRE(all.size() == 6);
  CHECK(all[0].type == "BASIS_SUGG_T");
  CHECK(all[1].name == "XP1");
  CHECK(all[1].type == "E6POS");
  CHECK(all[1].line == 8);
  CHECK(all[1].find("X")->number() == 814.246033);
  CHECK(all[1].find("Y")->number() == -0.0015);
  CHECK(all[1].find("Z")->number() == 620.0);
  CHECK(all[1].find("T")->bits() == 35U);
  CHECK(all[1].find("E7") == nullptr);
  CHECK(all[2].find("IPO_FRAME")->text == "#BASE");
  CHECK(all[2].find("POINT2[]")->text == "\" \"");
  CHECK(all[3].type == "E6AXIS");
  CHECK(all[3].name == "XHOME");
  CHECK(all[3].find("A2")->number() == -90.0);
  CHECK(all[4].type == "E6POS");  // by the array's declaration
  CHECK(all[4].name == "XP[2]");
  CHECK(all[4].find("S")->bits() == 2U);
  CHECK(all[4].find("T")->bits() == 0x23U);
  CHECK(all[5].type == "E6POS");
  for (const auto& one : all)
    for (const auto& field : one.fields)
      CHECK(kModule.substr(field.at, field.text.size()) == field.text);
}

TEST_CASE("A module that was cut anywhere is refused, or has whole points", "[krl_data]") {
  const auto whole = krl_aggregates(kModule);
  for (std::size_t size = 0; size < kModule.size(); ++size) {
    const auto cut = kModule.substr(0, size);
    try {
      const auto all = krl_aggregates(cut);
      // Nothing was begun yet, or all is there but the last line's end.
      CHECK((all.empty() || size >= kModule.size() - 2));
    } catch (const KrlError& error) {
      CHECK_THAT(error.what(), ContainsSubstring("line "));
    }
  }
  CHECK_THROWS_WITH(krl_aggregates("DECL E6POS XP1={X 1.0,Y 2"),
                    ContainsSubstring("line 1: the braces or quotes of XP1 are not closed"));
  using namespace std::string_literals;
  CHECK_THROWS_WITH(krl_aggregates("D\0E\0F\0"s), ContainsSubstring("UTF-16"));
}

TEST_CASE("Frames are read and written as KRL has them", "[krl_data]") {
  const auto frame = krl_frame("{X 1.5,Y -2,Z 3,A 30,B -20,C 170}");
  CHECK(krl_frame_text(frame) == "{X 1.5000,Y -2.0000,Z 3.0000,A 30.0000,B -20.0000,C 170.0000}");
  CHECK(krl_frame("X 1, Y 2, Z 3, A 0, B 0, C 0").translation().y() == 2);
  CHECK(from_gimbal_deg(krl_frame("{X 0,Y 0,Z 0,A 10,B 89.9,C 20}").linear()) ==
        Approx(0.1).margin(1e-9));
  CHECK_THROWS_WITH(krl_frame("{X 1,Y 2}"), ContainsSubstring("Z is missing"));
  CHECK_THROWS_WITH(krl_frame("{X a,Y 2}"), ContainsSubstring("X is no number"));
  CHECK_THROWS_WITH(krl_frame("{X 1e9,Y 2,Z 0,A 0,B 0,C 0}"), ContainsSubstring("too large"));
  CHECK_THROWS_WITH(krl_frame("{X 1"), ContainsSubstring("not closed"));
  CHECK_THROWS_AS(krl_frame(""), KrlError);
  CHECK_THROWS_AS(krl_frame("}"), KrlError);
}
