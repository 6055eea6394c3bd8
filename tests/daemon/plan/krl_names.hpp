#pragma once

#include <map>
#include <set>
#include <string>

// What KRL, KSS and the RSI packages know of themselves, as far as these programs use it; in
// capitals.

namespace sweepd::test {

inline const std::set<std::string> kTypes = {"AXIS",  "BOOL", "CHAR", "E6AXIS", "E6POS",
                                             "FRAME", "INT",  "POS",  "REAL",   "RSIERR"};
inline const std::set<std::string> kKeywords = {
    "AND",    "BAS_COMMAND", "CONTINUE", "DECL",  "DO",      "ELSE",     "END",
    "EXT",    "EXIT",        "FALSE",    "FOR",   "GLOBAL",  "HALT",     "IF",
    "IN",     "INTERRUPT",   "NOT",      "OFF",   "ON",      "OR",       "OUT",
    "PTP",    "REPEAT",      "RETURN",   "SEC",   "THEN",    "TO",       "TRUE",
    "UNTIL",  "WAIT",        "WHEN",     "WHILE", "LOOP",    "ENDLOOP",  "ENDIF",
    "ENDFOR", "ENDWHILE",    "SWITCH",   "CASE",  "DEFAULT", "ENDSWITCH"};
/// What KSS and the RSI packages declare.
inline const std::set<std::string> kKnown = {
    "BAS", "IR_STOPM", "TOOL_DATA", "SQRT", "ABS",
    // RSI 3 to 5
    "RSI_CREATE", "RSI_ON", "RSI_OFF", "RSI_DELETE", "RSIOK",
    // RSI 6
    "RSI_LOAD", "RSI_ACTIVATE", "RSI_PROCESS_ON", "RSI_PROCESS_OFF",
    // RSI 2
    "ST_ETHERNET", "ST_ACTPOS", "ST_NEWLINK", "ST_SETPARAM", "ST_ON", "ST_ON1", "ST_OFF",
    "ST_SKIPSENS", "EERXPRECISION", "EERXMAXLATEPACKAGES", "EERXFASTCYCLE"};
inline const std::set<std::string> kSystem = {"$ACC_AXIS", "$AXIS_ACT", "$BASE", "$NULLFRAME",
                                              "$POS_ACT",  "$STOPMESS", "$TOOL", "$VEL_AXIS"};
inline const std::set<std::string> kConstants = {"#ABSOLUTE", "#BASE",  "#INITMOV",
                                                 "#RELATIVE", "#RSIOK", "#TOOL"};
inline const std::map<std::string, std::string> kBlocks = {
    {"DEF", "END"},      {"DEFFCT", "ENDFCT"}, {"DEFDAT", "ENDDAT"},
    {"IF", "ENDIF"},     {"FOR", "ENDFOR"},    {"WHILE", "ENDWHILE"},
    {"LOOP", "ENDLOOP"}, {"REPEAT", "UNTIL"},  {"SWITCH", "ENDSWITCH"}};

}  // namespace sweepd::test
