/// \file
/// The layer under a back end's kernels: memory, and loops over tiles. The same text is compiled by
/// nvcc for a device, and by any compiler for the processor, where loops stand for threads.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "device/engine.h"

#if defined(__CUDACC__)
#include <cuda_runtime.h>
#define FLOE_KERNEL __device__
#else
#define FLOE_KERNEL
#endif

namespace floe::device {
namespace {  // of each back end its own

#if defined(__CUDACC__)

inline void check(cudaError_t code, const char* what) {
  if (code == cudaErrorMemoryAllocation)
    throw Failed(std::string("CUDA: the memory of the device is full: ") + what);
  if (code != cudaSuccess)
    throw Failed(std::string("CUDA: ") + what + ": " + cudaGetErrorString(code));
}

/// Numbers in the memory of the device.
template <class T>
class Array {
 public:
  explicit Array(std::size_t size = 0) : size_(size) {
    if (size > 0) check(cudaMalloc(&data_, size * sizeof(T)), "cudaMalloc");
    if (size > 0) check(cudaMemset(data_, 0, size * sizeof(T)), "cudaMemset");
  }
  explicit Array(std::span<const T> values) : Array(values.size()) { put(values); }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  Array(Array&& other) noexcept : data_(other.data_), size_(other.size_) { other.data_ = nullptr; }
  Array& operator=(Array&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~Array() { cudaFree(data_); }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  void put(std::span<const T> values, std::size_t at = 0) {
    if (values.empty()) return;
    check(cudaMemcpy(data_ + at, values.data(), values.size_bytes(), cudaMemcpyHostToDevice),
          "cudaMemcpy");
  }
  void get(std::span<T> values, std::size_t at = 0) const {
    if (values.empty()) return;
    check(cudaMemcpy(values.data(), data_ + at, values.size_bytes(), cudaMemcpyDeviceToHost),
          "cudaMemcpy");
  }

  /// Copies numbers of another array.
  void take(const Array& other, std::size_t from, std::size_t count, std::size_t at) {
    if (count == 0) return;
    check(cudaMemcpy(data_ + at, other.data_ + from, count * sizeof(T), cudaMemcpyDeviceToDevice),
          "cudaMemcpy");
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Raises *address to value, both not negative; not a number counts as more than any. The bits of
/// such doubles are in the order of the numbers.
__device__ inline void raise(std::uint64_t* address, double value) {
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  const auto bits = static_cast<unsigned long long>(__double_as_longlong(value));
  auto* largest = reinterpret_cast<unsigned long long*>(address);
  // It only grows, so what is read may be old and tells all the same of most that they are smaller.
  if (bits > *static_cast<volatile unsigned long long*>(largest)) atomicMax(largest, bits);
}

/// Lowers *address to value; adds 1 to it and returns what it was; adds bits to it.
__device__ inline void lower(std::int32_t* address, std::int32_t value) {
  atomicMin(address, value);
}
__device__ inline std::int32_t add_one(std::int32_t* address) { return atomicAdd(address, 1); }
__device__ inline void add_bits(std::uint32_t* address, std::uint32_t bits) {
  atomicOr(address, bits);
}

/// One block of threads per tile.
constexpr int most_threads = 128;  ///< of a block
template <class Work>
__global__ void __launch_bounds__(most_threads) run_tile(const Work work) {
  extern __shared__ double shared[];
  const auto tile = static_cast<std::int32_t>(blockIdx.x);
  const auto threads = static_cast<std::int32_t>(blockDim.x);
  for (auto k = static_cast<std::int32_t>(threadIdx.x); k < work.beams(tile); k += threads)
    work.beam(tile, k, shared);
  __syncthreads();
  for (auto k = static_cast<std::int32_t>(threadIdx.x); k < work.bodies(tile); k += threads)
    work.body(tile, k, shared);
}

/// Counts bits; returns the number of the lowest bit of a mask that is not 0.
__device__ inline int count_bits(std::uint64_t mask) { return __popcll(mask); }
__device__ inline int lowest_bit(std::uint64_t mask) {
  return __ffsll(static_cast<long long>(mask)) - 1;
}

/// Lanes that work together: the threads of a warp. What is outside of calls is done by all of them
/// alike.
struct Warp {
  static constexpr int lanes = 32;

  __device__ static int lane() { return static_cast<int>(threadIdx.x % lanes); }
  /// Calls work(lane) in all lanes, which see what it has written.
  template <class Work>
  __device__ void each(const Work& work) const {
    __syncwarp();
    work(lane());
    __syncwarp();
  }
  /// Returns a mask of the lanes in which is(lane) is true.
  template <class Is>
  __device__ std::uint32_t ballot(const Is& is) const {
    __syncwarp();
    const std::uint32_t bits = __ballot_sync(~0U, is(lane()));
    __syncwarp();
    return bits;
  }
  /// Sums n numbers over those of `count` entries for which is(entry), in an order that depends on
  /// these alone: the k-th of them is one of lane k mod 32.
  template <int n, class Is, class Add>
  __device__ void sums_of(double* numbers, std::int32_t count, const Is& is, const Add& add) const {
    for (int k = 0; k < n; ++k) numbers[k] = 0;
    int before = 0;
    for (std::int32_t begin = 0; begin < count; begin += lanes) {
      std::uint32_t mask = __ballot_sync(~0U, begin + lane() < count && is(begin + lane()));
      const int of = (lane() - before) & (lanes - 1), number = __popc(mask);
      before += number;
      if (of >= number) continue;
      for (int k = 0; k < of; ++k) mask &= mask - 1;
      add(begin + __ffs(static_cast<int>(mask)) - 1, numbers);
    }
    __syncwarp();
    reduce<n>(numbers);
  }
  /// Sums n numbers over the lanes, in a fixed order. \param add  add(lane, numbers) adds to zeros
  template <int n, class Add>
  __device__ void sums(double* numbers, const Add& add) const {
    for (int k = 0; k < n; ++k) numbers[k] = 0;
    add(lane(), numbers);
    reduce<n>(numbers);
  }

 private:
  template <int n>
  __device__ static void reduce(double* numbers) {
    for (int k = 0; k < n; ++k) {
      for (int d = lanes / 2; d > 0; d /= 2) numbers[k] += __shfl_xor_sync(~0U, numbers[k], d);
    }
    __syncwarp();
  }
};

/// One warp per item, with room in shared memory.
template <class Work>
__global__ void __launch_bounds__(most_threads) run_warps(const Work work, std::int32_t items) {
  extern __shared__ double shared[];
  const auto warp = static_cast<std::int32_t>(threadIdx.x / Warp::lanes);
  const std::int32_t item =
      static_cast<std::int32_t>(blockIdx.x) * (most_threads / Warp::lanes) + warp;
  if (item < items) work.warp(item, Warp{}, reinterpret_cast<typename Work::Room*>(shared)[warp]);
}

/// Work that is queued in order.
class Queue {
 public:
  Queue() { check(cudaStreamCreate(&stream_), "cudaStreamCreate"); }
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;
  ~Queue() {
    forget();
    cudaStreamDestroy(stream_);
  }
  /// Forgets all recorded launches: memory that they know has moved.
  void forget() {
    for (const auto& [key, graph] : graphs_) cudaGraphExecDestroy(graph);
    graphs_.clear();
  }

  /// Makes the launches of record(launch), where launch(work, tiles, threads, shared) runs the work
  /// for all tiles, or for all items of which each has a warp; one after the other. The same key
  /// stands for the same launches, which are recorded once, as a graph.
  template <class Record>
  void run(std::uint64_t key, const Record& record) {
    auto found = std::find_if(graphs_.begin(), graphs_.end(),
                              [&](const auto& entry) { return entry.first == key; });
    if (found == graphs_.end()) {
      cudaGraph_t graph = nullptr;
      check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "capture");
      try {
        once(record);
      } catch (...) {
        cudaStreamEndCapture(stream_, &graph);
        if (graph != nullptr) cudaGraphDestroy(graph);
        throw;
      }
      check(cudaStreamEndCapture(stream_, &graph), "capture");
      cudaGraphExec_t ready = nullptr;
      const cudaError_t made = cudaGraphInstantiate(&ready, graph, 0);
      cudaGraphDestroy(graph);
      check(made, "cudaGraphInstantiate");
      graphs_.emplace_back(key, ready);
      found = graphs_.end() - 1;
    }
    check(cudaGraphLaunch(found->second, stream_), "cudaGraphLaunch");
  }
  /// Makes such launches without recording them.
  template <class Record>
  void once(const Record& record) {
    record([this](const auto& work, std::int32_t tiles, int threads, std::size_t shared) {
      using Work = std::decay_t<decltype(work)>;
      if (tiles == 0) return;
      if constexpr (requires { typename Work::Room; }) {
        constexpr int of_block = most_threads / Warp::lanes;
        run_warps<<<static_cast<unsigned>((tiles + of_block - 1) / of_block), most_threads,
                    of_block * sizeof(typename Work::Room), stream_>>>(work, tiles);
      } else {
        constexpr std::size_t without_asking = 48U << 10;
        if (shared > without_asking)
          check(cudaFuncSetAttribute(run_tile<Work>, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                     static_cast<int>(shared)),
                "shared memory of a tile");
        run_tile<<<static_cast<unsigned>(tiles), threads, shared, stream_>>>(work);
      }
      check(cudaGetLastError(), "launch");
    });
  }
  void wait() { check(cudaStreamSynchronize(stream_), "a kernel"); }

 private:
  cudaStream_t stream_ = nullptr;
  std::vector<std::pair<std::uint64_t, cudaGraphExec_t>> graphs_;
};

#else  // the processor

template <class T>
class Array {
 public:
  explicit Array(std::size_t size = 0) : values_(size) {}
  explicit Array(std::span<const T> values) : values_(values.begin(), values.end()) {}

  T* data() { return values_.data(); }
  std::size_t size() const { return values_.size(); }
  void put(std::span<const T> values, std::size_t at = 0) {
    std::copy(values.begin(), values.end(), values_.begin() + static_cast<std::ptrdiff_t>(at));
  }
  void get(std::span<T> values, std::size_t at = 0) const {
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(at), values.size(), values.begin());
  }

  void take(const Array& other, std::size_t from, std::size_t count, std::size_t at) {
    put(std::span<const T>(other.values_).subspan(from, count), at);
  }

 private:
  std::vector<T> values_;
};

inline void raise(std::uint64_t* address, double value) {
  *address = std::max(*address, std::bit_cast<std::uint64_t>(value));
}

inline void lower(std::int32_t* address, std::int32_t value) {
  *address = std::min(*address, value);
}
inline std::int32_t add_one(std::int32_t* address) { return (*address)++; }
inline void add_bits(std::uint32_t* address, std::uint32_t bits) { *address |= bits; }

inline int count_bits(std::uint64_t mask) { return std::popcount(mask); }
inline int lowest_bit(std::uint64_t mask) { return std::countr_zero(mask); }

/// Lanes one after the other, with the sums of a warp.
struct Warp {
  static constexpr int lanes = 32;

  template <class Work>
  void each(const Work& work) const {
    for (int lane = 0; lane < lanes; ++lane) work(lane);
  }
  template <class Is>
  std::uint32_t ballot(const Is& is) const {
    std::uint32_t bits = 0;
    for (int lane = 0; lane < lanes; ++lane) bits |= std::uint32_t{is(lane) ? 1U : 0U} << lane;
    return bits;
  }
  template <int n, class Add>
  void sums(double* numbers, const Add& add) const {
    double of[lanes][n] = {};  // NOLINT: as the registers of a warp
    for (int lane = 0; lane < lanes; ++lane) add(lane, of[lane]);
    reduce<n>(of, numbers);
  }
  template <int n, class Is, class Add>
  void sums_of(double* numbers, std::int32_t count, const Is& is, const Add& add) const {
    double of[lanes][n] = {};  // NOLINT
    int before = 0;
    for (std::int32_t e = 0; e < count; ++e)
      if (is(e)) add(e, of[before++ % lanes]);
    reduce<n>(of, numbers);
  }

 private:
  template <int n>
  static void reduce(double (&of)[lanes][n], double* numbers) {  // NOLINT
    for (int d = lanes / 2; d > 0; d /= 2) {
      for (int lane = 0; lane < d; ++lane) {
        for (int k = 0; k < n; ++k) of[lane][k] += of[lane + d][k];
      }
    }
    for (int k = 0; k < n; ++k) numbers[k] = of[0][k];
  }
};

constexpr int most_threads = 128;

class Queue {
 public:
  template <class Record>
  void run(std::uint64_t /*key*/, const Record& record) {
    record([this](const auto& work, std::int32_t tiles, int /*threads*/, std::size_t shared) {
      using Work = std::decay_t<decltype(work)>;
      if constexpr (requires { typename Work::Room; }) {
        typename Work::Room room{};
        for (std::int32_t item = 0; item < tiles; ++item) work.warp(item, Warp{}, room);
      } else {
        shared_.resize(std::max(shared_.size(), shared / sizeof(double)));
        for (std::int32_t tile = 0; tile < tiles; ++tile) {
          for (std::int32_t b = 0; b < work.beams(tile); ++b) work.beam(tile, b, shared_.data());
          for (std::int32_t b = 0; b < work.bodies(tile); ++b) work.body(tile, b, shared_.data());
        }
      }
    });
  }
  template <class Record>
  void once(const Record& record) {
    run(0, record);
  }
  void wait() {}
  void forget() {}

 private:
  std::vector<double> shared_;  ///< of one tile
};

#endif

}  // namespace
}  // namespace floe::device
