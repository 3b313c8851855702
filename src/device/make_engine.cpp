#include "device/make_engine.h"

#include <string>
#include <utility>

#include "floe/base/petsc.h"

namespace floe::device {

void check_is_built(std::string_view backend) {
  if (backend == "cuda" && !has_cuda()) make_cuda_engine({});
}

std::unique_ptr<Engine> make_engine(std::string_view backend, std::vector<Lattice> lattices) {
  if (backend == "loop") return make_loop_engine(std::move(lattices));
  if (backend != "cuda")
    throw InputError("backend: " + std::string(backend) + " must be one of loop | cuda");
  if (has_cuda() && name_of_device().empty())
    throw InputError("backend: cuda: this machine has no device that CUDA finds");
  return make_cuda_engine(std::move(lattices));
}

}  // namespace floe::device
