#pragma once

#include "identify/identification.hpp"

namespace identify {

/// A table is complete where every number of it is known. Where one is undetermined though no axis
/// is missing, the status becomes partial, and the reason and a warning (`undetermined`) name it.
void name_undetermined(Identification& found);

}  // namespace identify
