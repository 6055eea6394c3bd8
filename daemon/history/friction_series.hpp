#pragma once

namespace sweepd {

struct History;

/// Friction of each joint over the campaigns, and its dated changes. How much friction scatters is
/// taken from what differs from one campaign to the next.
void find_friction(History& history);

}  // namespace sweepd
