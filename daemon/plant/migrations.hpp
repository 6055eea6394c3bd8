#pragma once

#include "daemon/plant/database.hpp"

namespace sweepd {

/// Brings the tables to what this sweepd knows. Any number of programs at once. Throws
/// DatabaseError, and std::runtime_error where the tables are of a newer sweepd.
void migrate(Database& database);

}  // namespace sweepd
