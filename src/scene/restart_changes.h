/// \file
/// What a run that goes on from a checkpoint may have changed (docs/restarts.md).
#pragma once

#include <string_view>

#include "floe/base/options.h"

namespace floe {

/// \throws InputError for an option of the scene or the command line that may not change and
/// differs from the checkpoint's, with both values. Nothing where there is no checkpoint.
void refuse_changes(const UserOptions& user);

/// \throws InputError for an option that may not change, has an effect and is not among the
/// checkpoint's. \param options  all have been read
void refuse_additions(const Options& options, const UserOptions& user);

/// Whether a restart takes an option along that is not given anew: not what bounds or watches one
/// part of a run.
bool is_taken_along(std::string_view option);

}  // namespace floe
