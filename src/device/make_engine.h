/// \file
/// The engine of a back end by its name.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "device/engine.h"

namespace floe::device {

/// \throws InputError if floe is built without this back end
void check_is_built(std::string_view backend);
/// \param backend  loop or cuda
/// \param lattices  one per run
/// \throws InputError if there is no such back end here, Failed for errors of a device
std::unique_ptr<Engine> make_engine(std::string_view backend, std::vector<Lattice> lattices);

}  // namespace floe::device
