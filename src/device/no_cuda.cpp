// In place of cuda.cu where floe is built without CUDA.
#include "device/engine.h"
#include "floe/base/petsc.h"

namespace floe::device {

// NOLINTNEXTLINE(performance-unnecessary-value-param): as cuda.cu takes them
std::unique_ptr<Engine> make_cuda_engine(std::vector<Lattice> /*lattices*/, std::int32_t /*tile*/) {
  throw InputError(
      "backend: cuda: this floe is built without it (cmake -DFLOE_CUDA=ON, which needs CUDA 12 or "
      "13); backend: cpu needs nothing");
}

bool has_cuda() { return false; }

std::string name_of_device() { return ""; }

}  // namespace floe::device
