/// \file
/// Whether runs show their progress.
#pragma once

namespace floe {

/// Sets whether Progress objects that are made from now on print; by default they do.
void show_progress(bool yes);

}  // namespace floe
