/// \file
/// Runs of several processes whose steps one process makes, many runs in a launch (decision 67,
/// "Batches"). Each run is a process as ever, whose engine is at the other end of a connection.
#pragma once

#include <csignal>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/bytes.h"
#include "device/engine.h"

namespace floe::device {

/// A message between two processes: a word and what belongs to it.
struct Message {
  std::uint32_t word = 0;
  Bytes bytes;
};

/// An end of a connection between two processes (socketpair(2)).
class Connection {
 public:
  /// \param file  descriptor, which this object closes
  explicit Connection(int file) : file_(file) {}
  Connection(Connection&& other) noexcept;
  Connection& operator=(Connection&&) = delete;
  ~Connection();

  int file() const { return file_; }
  /// Sends a message. False: the process at the other end is gone.
  bool send(std::uint32_t word, const Bytes& bytes) const;
  /// Waits for a message. Nothing: the process at the other end is gone.
  std::optional<Message> receive() const;

 private:
  int file_;
};

/// The runs of several processes, each of which has joined by join_batch(). All are waited for
/// before the first launch; one whose process ends leaves. A launch is made when each run that is
/// left wants steps, with as many as each wants. Runs of different kinds (Kind) have engines of
/// their own, so that the bits of a run do not depend on the others.
class Batch {
 public:
  using Maker = std::function<std::unique_ptr<Engine>(std::vector<Lattice>)>;

  /// \param files  descriptors of the connections to the runs, which this object closes
  Batch(Maker make, const std::vector<int>& files);
  ~Batch();
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  /// Serves the runs until all have left.
  /// \param impatient  where not 0: runs that have not asked for what others wait for are left
  ///                   behind, so that those go on; set to 0 then
  void serve(volatile std::sig_atomic_t* impatient = nullptr);

  std::size_t engines() const { return groups_.size(); }
  std::int64_t launches() const { return launches_; }
  /// Steps of all launches; those of runs in one launch count once.
  std::int64_t steps() const { return steps_; }

 private:
  struct Member;
  struct Group;

  void look(Member& member, bool has_message);
  void take(Member& member, Message message);
  void answer(Member& member, Message& message);
  void make_engines();
  void leave_behind();
  void launch_if_due(Group& group);

  Maker make_;
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<std::unique_ptr<Group>> groups_;
  bool all_have_joined_ = false;
  std::int64_t launches_ = 0, steps_ = 0;
};

/// Joins a batch, and returns the engine at the other end, which has this run alone. Waits until
/// all have joined.
/// \param file  descriptor of a connection, which the engine closes
/// \throws Failed if the engine cannot be made, InputError as make_cuda_engine()
std::unique_ptr<Engine> join_batch(int file, const Lattice& lattice);

/// Whether a number is that of an open socket.
bool is_socket(int file);
/// Variable of the environment with the number of a process's connection to a batch.
inline constexpr const char* batch_variable = "FLOE_BATCH";
/// Returns that number, once: nothing if the process is of no batch. \throws InputError
std::optional<int> connection_to_batch();

}  // namespace floe::device
