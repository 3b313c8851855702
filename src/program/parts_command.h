/// \file
/// The command of the tool make_parts.
#pragma once

namespace floe::program {

/// Divides a solid into convex parts: floe -make_parts FILE UNIT TOLERANCE MOST_PARTS OUT.h5 (see
/// SolidFile). Writes OUT.h5 and prints what came of it as JSON; errors are one line on stderr.
/// \return the exit code
int make_parts(int argc, char** argv);

}  // namespace floe::program
