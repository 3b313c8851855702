// The back end on a device of NVIDIA. For tests it is compiled a second time, by another name, with
// FLOE_CUDA_EXACT and without fused operations: to the bits of the back end loop.
#include "device/engine_text.h"

namespace floe::device {

#if defined(FLOE_CUDA_EXACT)

std::unique_ptr<Engine> make_exact_cuda_engine(std::vector<Lattice> lattices, std::int32_t tile) {
  return make_engine(std::move(lattices), tile);
}

#else

std::unique_ptr<Engine> make_cuda_engine(std::vector<Lattice> lattices, std::int32_t tile) {
  return make_engine(std::move(lattices), tile);
}

bool has_cuda() { return true; }

std::string name_of_device() {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) return "";
  cudaDeviceProp facts;
  check(cudaGetDeviceProperties(&facts, 0), "cudaGetDeviceProperties");
  return std::string(facts.name) + ", compute capability " + std::to_string(facts.major) + "." +
         std::to_string(facts.minor);
}

#endif

}  // namespace floe::device
