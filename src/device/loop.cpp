// The back end on the processor: the text of the device in loops, for tests without one.
#include "device/engine_text.h"

namespace floe::device {

std::unique_ptr<Engine> make_loop_engine(std::vector<Lattice> lattices, std::int32_t tile) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): the pointer goes to the caller
  return make_engine(std::move(lattices), tile);
}

}  // namespace floe::device
