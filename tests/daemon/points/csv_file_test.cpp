#include "daemon/points/csv_file.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using sweepd::CsvError;
using sweepd::CsvFile;
using sweepd::test::TemporaryFolder;
using Names = std::vector<std::string>;

namespace {

/// The numbers of all lines; -1 where a field is empty.
std::vector<std::vector<double>> numbers(CsvFile file) {
  std::vector<std::vector<double>> lines;
  while (file.next()) {
    lines.emplace_back();
    for (std::size_t k = 0; k < file.columns().size(); ++k) {
      const auto number = file.decimal(k);
      lines.back().push_back(number ? number->value : -1);
    }
  }
  return lines;
}

const std::vector<std::vector<double>> kTwoLines{{1, 2.5}, {-3, -1}};

}  // namespace

TEST_CASE("columns stand between commas, semicolons, tabs or blanks", "[csv_file]") {
  const TemporaryFolder folder;
  for (const std::string text : {"x,y\n1,2.5\n-3,\n", "x;y\n1;2.5\n-3;\n", "x\ty\n1\t2.5\n-3\t\n",
                                 " x, y\n 1,\t+2.5\n\"-3\",\"\"", "x,y\r\n1,2.5\r\n-3,\r\n"}) {
    INFO(text);
    CHECK(numbers(CsvFile(folder.write("x.csv", text))) == kTwoLines);
  }
  CHECK(numbers(CsvFile(folder.write("x.csv", "x  y\n 1   2.5 \n-3 -1\n"))) == kTwoLines);
}

TEST_CASE("what stands in quotes is one field, whatever it holds",
          "[csv_file][issue11][point_14]") {
  const TemporaryFolder folder;
  CsvFile file(folder.write(
      "x.csv", "\"a, in mm\";\"say \"\"b\"\"\";c\r\n \"1\" ;\"2;\r\n3\";\"\"\"\"\r\n4;5\"6;7"));
  CHECK(file.columns() == Names{"a, in mm", "say \"b\"", "c"});
  REQUIRE(file.next());
  CHECK(file.number(0) == 1);
  CHECK(file.text(1) == "2;\r\n3");
  CHECK(file.text(2) == "\"");
  REQUIRE(file.next());
  CHECK(file.line() == 4);
  CHECK(file.text(1) == "5\"6");
  CHECK_FALSE(file.next());
  CsvFile open(folder.write("x.csv", "a,b\n1,\"2\n3,4\n"));
  CHECK_THROWS_WITH(open.next(), ContainsSubstring("x.csv: line 2: expected a closing quote"));
  CsvFile more(folder.write("x.csv", "a,b\n1,\"2\"3\n"));
  CHECK_THROWS_WITH(more.next(),
                    ContainsSubstring("line 2: expected the next field after a closing quote"));
}

TEST_CASE("empty lines, comments and a byte order mark are passed over, and lines still count",
          "[csv_file]") {
  const TemporaryFolder folder;
  CsvFile file(folder.write("x.csv", "\xef\xbb\xbf# made by hand\r\n\nx,y\n\n  \n#1,1\n1,2\n"));
  CHECK(file.columns() == Names{"x", "y"});
  REQUIRE(file.next());
  CHECK(file.line() == 7);
  CHECK(file.number(1) == 2);
  CHECK_FALSE(file.next());
}

TEST_CASE("columns named outside of the file win over its header", "[csv_file]") {
  const TemporaryFolder folder;
  const Names names{"x", "-", "y"};
  for (const std::string text :
       {"1,revolute,2.5\n-3,revolute,\n", "a,b,c\n1,revolute,2.5\n-3,revolute,\n"}) {
    INFO(text);
    CsvFile file(folder.write("x.csv", text), names);
    CHECK(file.columns() == Names{"x", "", "y"});
    REQUIRE(file.next());
    CHECK(file.number(0) == 1);
    CHECK(file.number(2) == 2.5);
    REQUIRE(file.next());
    CHECK_FALSE(file.next());
  }
  // One good number makes a line data, and its mistake one to be told.
  CsvFile file(folder.write("x.csv", "abc,revolute,2.5\n"), names);
  REQUIRE(file.next());
  CHECK_THROWS_WITH(file.number(0), ContainsSubstring("line 1, column 1 (x)"));
}

TEST_CASE("columns without a name, or named - or _, are skipped", "[csv_file]") {
  const TemporaryFolder folder;
  CHECK(CsvFile(folder.write("x.csv", ",x,-,_\n1,2,3,4\n")).columns() == Names{"", "x", "", ""});
}

TEST_CASE("decimals are those that the value has, with an exponent too", "[csv_file]") {
  const TemporaryFolder folder;
  CsvFile file(folder.write("x.csv", "a,b,c,d\n-90.0,1.25e-3,1.5e+1,1e3\n"));
  REQUIRE(file.next());
  CHECK(file.decimal(0)->decimals == 1);
  CHECK(file.decimal(1)->decimals == 5);
  CHECK(file.decimal(2)->decimals == 0);
  CHECK(file.decimal(3)->decimals == -3);
  CHECK(file.decimal(1)->value == 1.25e-3);
}

TEST_CASE("a zero may be written with any exponent", "[csv_file]") {
  const TemporaryFolder folder;
  for (const std::string zero : {"0e-2147483648", "0e2147483647", "0.0e-2147483647", "0e400"}) {
    INFO(zero);
    CsvFile file(folder.write("x.csv", "a,b\n" + zero + ",1\n"));
    REQUIRE(file.next());
    CHECK(file.decimal(0)->value == 0);
    CHECK(file.decimal(0)->decimals >= -12);  // no measured number has more digits before the point
  }
}

TEST_CASE("an error of a CSV file is one line, whatever the file holds", "[csv_file]") {
  const TemporaryFolder folder;
  CsvFile file(folder.write("x.csv", "a\x1b,b\n1\r2,\x7f\n"));
  REQUIRE(file.next());
  CHECK_THROWS_WITH(file.number(0),
                    ContainsSubstring("column 1 (a?)") && ContainsSubstring("found \"1?2\""));
  CHECK_THROWS_WITH(file.number(1), ContainsSubstring("found \"?\""));
  CHECK_THROWS_WITH(file.fail_header(0, "wrong"), ContainsSubstring("column 1 (a?): wrong"));
}

TEST_CASE("what is no finite number is told with line, column and name", "[csv_file]") {
  const TemporaryFolder folder;
  const auto path = folder.write("points.csv", "t_s,x_mm,y_mm\n# comment\n0,1,2\n1,3,abc\n");
  CsvFile file(path);
  REQUIRE(file.next());
  CHECK(file.number(2) == 2);
  REQUIRE(file.next());
  CHECK_THROWS_AS(file.number(2), CsvError);
  CHECK_THROWS_WITH(file.number(2),
                    path.string() +
                        ": line 4, column 3 (y_mm): expected a number, found \"abc\": correct it, "
                        "or leave it empty if the value is missing");
  for (const std::string wrong :
       {"nan", "inf", "-inf", "NaN", "1e999", "0x10", "1 2", "--1", "1.2.3", "1e13", "-2e300"}) {
    INFO(wrong);
    CsvFile other(folder.write("x.csv", "x,y\n1," + wrong + "\n"));
    REQUIRE(other.next());
    CHECK_THROWS_WITH(other.number(1), ContainsSubstring("line 2, column 2 (y): expected a") &&
                                           ContainsSubstring("found \"" + wrong + "\""));
  }
}

TEST_CASE("a decimal comma is told as such; a field that must be there may not be empty",
          "[csv_file]") {
  const TemporaryFolder folder;
  CsvFile file(folder.write("x.csv", "x;y\n1,5;\n"));
  REQUIRE(file.next());
  CHECK_THROWS_WITH(file.number(0), EndsWith("found \"1,5\": write a decimal point"));
  CHECK_THROWS_WITH(file.number(1), ContainsSubstring("line 2, column 2 (y)") &&
                                        EndsWith("found nothing: fill it in"));
}

TEST_CASE("whole numbers are told from others and from those out of range", "[csv_file]") {
  const TemporaryFolder folder;
  CsvFile file(folder.write("x.csv", "a,b,c,d\n3,3.0,3.5,13\n"));
  REQUIRE(file.next());
  CHECK(file.whole_number(0, 1, 12) == 3);
  CHECK(file.whole_number(1, 1, 12) == 3);
  for (const std::size_t column : {2U, 3U})
    CHECK_THROWS_WITH(file.whole_number(column, 1, 12),
                      ContainsSubstring("expected a whole number from 1 to 12, found"));
}

TEST_CASE("lines with more or fewer fields than columns are told", "[csv_file]") {
  const TemporaryFolder folder;
  for (const std::string line : {"1", "1,2,3"}) {
    CsvFile file(folder.write("x.csv", "\nx,y\n1,2\n" + line + "\n"));
    REQUIRE(file.next());
    CHECK_THROWS_WITH(file.next(),
                      ContainsSubstring("x.csv: line 4: expected 2 columns, as in line 2, found " +
                                        std::to_string((line.size() + 1) / 2)));
  }
  CsvFile file(folder.write("x.csv", "1,2\n"), {"x"});
  CHECK_THROWS_WITH(file.next(), ContainsSubstring("expected 1 column, as named with --columns") &&
                                     ContainsSubstring("- for one to skip"));
}

TEST_CASE("files without lines, without a header, or that cannot be read are told", "[csv_file]") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(CsvFile(folder.write("x.csv", "\n# nothing\n")),
                    ContainsSubstring("x.csv: expected lines of numbers, found none"));
  CHECK_THROWS_WITH(
      CsvFile(folder.write("x.csv", "1,2\n3,4\n")),
      ContainsSubstring("x.csv: line 1: expected a header") && ContainsSubstring("--columns"));
  CHECK_THROWS_WITH(CsvFile(folder / "missing.csv"),
                    ContainsSubstring("missing.csv: cannot be read: No such file or directory: "
                                      "check the path and the permissions"));
  CHECK_THROWS_WITH(CsvFile(folder.path()), ContainsSubstring("cannot be read: Is a directory: "));
}

TEST_CASE("any bytes are read or refused, never worse", "[csv_file]") {
  const TemporaryFolder folder;
  using namespace std::string_literals;
  const std::string bytes = "x,y\n\0,\xff\n\"\",\"\n\",\"\"\n,,\n"s;
  for (std::size_t length = 0; length <= bytes.size(); ++length) {
    const auto path = folder.write("x.csv", bytes.substr(0, length));
    try {
      CsvFile file(path);
      while (file.next()) static_cast<void>(file.decimal(0));
    } catch (const CsvError& problem) {
      CHECK_THAT(problem.what(), ContainsSubstring("x.csv"));
    }
  }
}

TEST_CASE("a column whose name is too long is told by the beginning of its name", "[csv_file]") {
  const TemporaryFolder folder;
  const std::string letters(59, 'k');
  std::string name = letters;
  for (int i = 0; i < 50'000; ++i) name += "\xc3\xa4";  // is not cut in two
  CsvFile file(folder.write("x.csv", "t_s," + name + "\n1,no\n"));
  REQUIRE(file.next());
  CHECK_THROWS_WITH(file.number(1), ContainsSubstring("line 2, column 2 (" + letters + "...): "));
  CHECK_THROWS_WITH(file.fail_header(1, "unknown"),
                    ContainsSubstring("column 2 (" + letters + "...): unknown"));
}

TEST_CASE(
    "a file that may be cut within its last field is refused, one that just has no end is read",
    "[csv_file]") {
  const TemporaryFolder folder;
  const auto lines = [&](const std::string& text, const Names& columns = {}) {
    return numbers(CsvFile(folder.write("x.csv", text), columns)).size();
  };
  const std::string all = "x,y\n1,424.5039\n-3,-424.0234\n1,424.6206";
  CHECK(lines(all) == 3);
  for (const std::size_t off : {1U, 2U, 3U, 4U, 5U, 6U, 7U}) {
    INFO(all.substr(0, all.size() - off));
    CHECK_THROWS_WITH(lines(all.substr(0, all.size() - off)),
                      ContainsSubstring("x.csv: line 4, column 2 (y): expected 4 decimals or more "
                                        "and the end of the line, found \"4") &&
                          EndsWith("copy or export it again, or end its last line if it is whole"));
  }
  CHECK(lines(all.substr(0, all.size() - 2) + "\n") == 3);  // the writer ended it
  CHECK(lines("x,y\n1,424.5039\n1,\"424.6\"") == 2);
  CHECK(lines("x,y\n1,424.5039\n1,424.6\r") == 2);
  CHECK(lines("x,y\n1,424.5039\n1,") == 2);  // missing, as it says
  // Digits as they come: not all may be longer than the last.
  CHECK(lines("x,y\n1,0.25\n2,0.125\n3,0.25") == 3);
  CHECK(lines("x,y\n1,0.25\n2,0.5\n3,0.125\n4,0.3") == 4);
  CHECK_THROWS_WITH(lines("x,y\n1,0.25\n2,0.125\n3,0.3"), ContainsSubstring("2 decimals or more"));
  CHECK_THROWS_WITH(lines("x,y\n1,0.25\n2,5\n3,0."), ContainsSubstring("may be cut"));
  CHECK(lines("x,joint\n1,9\n2,10\n3,8") == 3);
  CHECK_THROWS_WITH(lines("x,y\n1,1.5e-10\n2,2.5e-1"), ContainsSubstring("may be cut"));
  // Whole numbers, and the same one again.
  CHECK(lines("x,joint\n1,10\n2,11") == 2);
  CHECK(lines("x,joint\n1,10\n2,1\n3,1") == 3);
  CHECK_THROWS_WITH(lines("x,joint\n1,10\n2,1"), ContainsSubstring("may be cut"));
  // Nothing tells of one line alone; nobody reads a column without a name.
  CHECK_THROWS_WITH(lines("x,y\n1,424.5"), ContainsSubstring("may be cut"));
  CHECK(lines("1,424.5039\n1,42", {"x", "-"}) == 2);
}

TEST_CASE("a sign between thousands is told as such", "[csv_file]") {
  const TemporaryFolder folder;
  for (const std::string wrong : {"1,234", "\"1,234.5\"", "1'234.5", "1 234", "-12,345,678"}) {
    INFO(wrong);
    CsvFile file(folder.write("x.csv", "x;y\n" + wrong + ";1\n"));
    REQUIRE(file.next());
    CHECK_THROWS_WITH(file.number(0),
                      ContainsSubstring("line 2, column 1 (x): expected a number") &&
                          EndsWith("nothing between thousands, and a decimal point"));
  }
}
