#include "batch_command.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "device/batch.h"
#include "device/make_engine.h"
#include "program.h"

namespace floe::program {
namespace {

volatile std::sig_atomic_t impatient = 0;

int refuse(const std::string& why) {
  std::fprintf(stderr, "floe: %s\n", why.c_str());
  return bad_input;
}

}  // namespace

int serve_batch(int argc, char** argv) {
  std::vector<int> files;
  for (int k = 3; k < argc; ++k) {
    const std::string_view word = argv[k];
    int file = -1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), file);
    if (error == std::errc{} && end == word.data() + word.size() && file > 2 &&
        device::is_socket(file) && std::find(files.begin(), files.end(), file) == files.end())
      files.push_back(file);
  }
  if (files.empty() || files.size() != static_cast<std::size_t>(argc - 3)) {
    return refuse(
        "-batch BACKEND FILE...: FILE must be the numbers of different open connections (sockets), "
        "as floe ensemble gives them");
  }
  const std::string backend = argv[2];
  if (backend != "loop" && backend != "cuda")
    return refuse("-batch: backend: " + backend + " must be one of loop | cuda");
  std::signal(SIGUSR1, [](int) { impatient = 1; });
  try {
    device::Batch batch(
        [&](std::vector<device::Lattice> lattices) {
          return device::make_engine(backend, std::move(lattices));
        },
        files);
    batch.serve(&impatient);
    std::printf("%zu runs, engines: %zu, launches: %lld, steps: %lld\n", files.size(),
                batch.engines(), static_cast<long long>(batch.launches()),
                static_cast<long long>(batch.steps()));
    return done;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "floe: %s\n", error.what());
    return failed;
  }
}

}  // namespace floe::program
