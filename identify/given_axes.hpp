#pragma once

#include <vector>

#include "identify/identification.hpp"

namespace identify {

/// The DH table of axes that are known as lines, from CAD say: nothing is estimated. `axes` are one
/// a joint of `campaign`.
///
/// A line may be given either way round. Where there is a specified table, each points as that has
/// it (where nothing but thetas would tell, as those at the table's home have it); otherwise as it
/// was given. The pose in which they were given is home: known only if the
/// campaign declares it.
[[nodiscard]] Identification identify_given_axes(const std::vector<Axis>& axes,
                                                 const Campaign& campaign);

}  // namespace identify
