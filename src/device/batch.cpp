#include "device/batch.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "floe/base/petsc.h"

namespace floe::device {
namespace {

/// Questions of a run; step has no answer.
enum class Ask : std::uint32_t {
  join,
  put,
  get,
  put_submerged,
  get_submerged,
  put_damage,
  get_damage,
  put_pairs,
  get_pairs,
  list_pairs,
  get_parted,
  put_worn,
  put_obstacles,
  get_obstacles,
  step,
  made,
  findings,
  works,
  put_works,
  forget_works
};
enum class Answer : std::uint32_t { good, failed, bad_input };

struct Head {
  std::uint64_t word, size;
};

bool send_all(int file, const void* from, std::size_t size) {
  const auto* next = static_cast<const std::byte*>(from);
  while (size > 0) {
    const ssize_t sent = ::send(file, next, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    next += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int file, void* to, std::size_t size) {
  auto* next = static_cast<std::byte*>(to);
  while (size > 0) {
    const ssize_t received = ::recv(file, next, size, 0);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) return false;
    next += received;
    size -= static_cast<std::size_t>(received);
  }
  return true;
}

Bytes bytes_of(std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Connection::Connection(Connection&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
Connection::~Connection() {
  if (file_ >= 0) ::close(file_);
}

bool Connection::send(std::uint32_t word, const Bytes& bytes) const {
  const Head head{word, bytes.size()};
  constexpr std::size_t room = 4096;
  std::array<std::byte, room> small;  // in one system call
  if (sizeof head + bytes.size() <= room) {
    std::memcpy(small.data(), &head, sizeof head);
    std::copy(bytes.begin(), bytes.end(), small.begin() + sizeof head);
    return send_all(file_, small.data(), sizeof head + bytes.size());
  }
  return send_all(file_, &head, sizeof head) && send_all(file_, bytes.data(), bytes.size());
}

std::optional<Message> Connection::receive() const {
  Head head{};
  if (!receive_all(file_, &head, sizeof head)) return {};
  Message message{static_cast<std::uint32_t>(head.word), Bytes(head.size)};
  if (!receive_all(file_, message.bytes.data(), message.bytes.size())) return {};
  return message;
}

/// A run at the other end of a connection.
struct Batch::Member {
  enum class Stand { joining, joined, ready, waiting, gone };

  Connection connection;
  Stand stand = Stand::joining;
  Lattice lattice{};  ///< until the engine is made
  Group* group = nullptr;
  std::size_t run = 0;  ///< of the group's engine
  Steps steps{};        ///< that it waits for
  std::string why{};    ///< they could not be made

  /// Sends an answer; a run that does not get it has left.
  void reply(Answer word, const Bytes& bytes = {}) {
    if (!connection.send(static_cast<std::uint32_t>(word), bytes)) stand = Stand::gone;
  }
};

/// Runs of one kind.
struct Batch::Group {
  std::string kind;
  std::vector<Member*> members;
  std::unique_ptr<Engine> engine;
};

Batch::Batch(Maker make, const std::vector<int>& files) : make_(std::move(make)) {
  for (const int file : files)
    members_.push_back(std::make_unique<Member>(Member{.connection = Connection(file)}));
}
Batch::~Batch() = default;

void Batch::serve(volatile std::sig_atomic_t* impatient) {
  using Stand = Member::Stand;
  while (true) {
    if (!all_have_joined_ && std::none_of(members_.begin(), members_.end(),
                                          [](const auto& m) { return m->stand == Stand::joining; }))
      make_engines();
    if (impatient != nullptr && *impatient != 0) {
      *impatient = 0;
      leave_behind();
      continue;
    }
    for (const auto& group : groups_) launch_if_due(*group);
    std::vector<pollfd> files;
    std::vector<Member*> asked;
    for (const auto& member : members_) {
      if (member->stand == Stand::gone) continue;
      // Of the others only their end is of interest.
      const bool listens = member->stand == Stand::joining || member->stand == Stand::ready;
      files.push_back({member->connection.file(), static_cast<short>(listens ? POLLIN : 0), 0});
      asked.push_back(member.get());
    }
    if (files.empty()) return;
    constexpr int a_while = 500;  // [ms]: a signal may come just before
    const int timeout = impatient != nullptr ? a_while : -1;
    if (::poll(files.data(), files.size(), timeout) < 0) {
      if (errno == EINTR) continue;
      throw Failed("the runs of a batch cannot be waited for: " +
                   std::generic_category().message(errno));
    }
    for (std::size_t k = 0; k < files.size(); ++k)
      if (files[k].revents != 0) look(*asked[k], (files[k].revents & POLLIN) != 0);
  }
}

/// Lets runs go for which others wait.
void Batch::leave_behind() {
  using Stand = Member::Stand;
  const auto waits = [](const auto& m) {
    return m->stand == Stand::joined || m->stand == Stand::waiting;
  };
  if (std::none_of(members_.begin(), members_.end(), waits)) return;
  for (const auto& member : members_) {
    if (member->stand == Stand::gone || waits(member)) continue;
    member->stand = Stand::gone;
    member->steps = {};
    ::shutdown(member->connection.file(), SHUT_RDWR);
  }
}

/// Takes the message of a run, or notes that it has left.
void Batch::look(Member& member, bool has_message) {
  std::optional<Message> message;
  if (has_message) message = member.connection.receive();
  if (message) {
    take(member, *std::move(message));
  } else {
    member.stand = Member::Stand::gone;
    member.steps = {};
  }
}

void Batch::take(Member& member, Message message) {
  try {
    if (member.stand == Member::Stand::joining) {
      member.lattice = Reader(std::move(message.bytes)).get<Lattice>();
      member.stand = Member::Stand::joined;
    } else if (message.word == static_cast<std::uint32_t>(Ask::step)) {
      member.steps = Reader(std::move(message.bytes)).get<Steps>();
      member.stand = Member::Stand::waiting;
    } else if (!member.why.empty()) {
      member.reply(Answer::failed, bytes_of(member.why));
    } else {
      answer(member, message);
    }
  } catch (const Failed& error) {
    member.reply(Answer::failed, bytes_of(error.what()));
  }
}

void Batch::answer(Member& member, Message& message) {
  Engine& engine = *member.group->engine;
  Reader question(std::move(message.bytes));
  Writer reply;
  const auto numbers = [&](void (Engine::*get)(std::size_t, std::span<double>)) {
    std::vector<double> values(question.get<std::uint64_t>());
    (engine.*get)(member.run, values);
    reply(values);
  };
  switch (static_cast<Ask>(message.word)) {
    case Ask::put:
      engine.put(member.run, question.get<std::vector<double>>());
      break;
    case Ask::get:
      numbers(&Engine::get);
      break;
    case Ask::put_submerged:
      engine.put_submerged(member.run, question.get<std::vector<double>>());
      break;
    case Ask::get_submerged:
      numbers(&Engine::get_submerged);
      break;
    case Ask::put_damage:
      engine.put_damage(member.run, question.get<Damage>());
      break;
    case Ask::get_damage:
      reply(engine.get_damage(member.run));
      break;
    case Ask::put_pairs:
      engine.put_pairs(member.run, question.get<Pairs>());
      break;
    case Ask::get_pairs: {
      Pairs pairs;
      engine.get_pairs(member.run, pairs);
      reply(pairs);
      break;
    }
    case Ask::list_pairs:
      reply(engine.list_pairs(member.run, question.get<std::vector<double>>()));
      break;
    case Ask::get_parted:
      reply(engine.get_parted(member.run));
      break;
    case Ask::put_worn:
      engine.put_worn(member.run, question.get<std::vector<WornPlane>>());
      break;
    case Ask::put_obstacles:
      engine.put_obstacles(member.run, question.get<std::vector<double>>());
      break;
    case Ask::get_obstacles:
      numbers(&Engine::get_obstacles);
      break;
    case Ask::made:
      reply(engine.made(member.run));
      break;
    case Ask::findings:
      reply(engine.findings(member.run));
      break;
    case Ask::works:
      reply(engine.works(member.run));
      break;
    case Ask::put_works:
      engine.put_works(member.run, question.get<Works>());
      break;
    case Ask::forget_works:
      engine.forget_works(member.run);
      break;
    default:
      throw Failed("a run of a batch has asked for what is not known");
  }
  member.reply(Answer::good, reply.bytes());
}

void Batch::make_engines() {
  all_have_joined_ = true;
  for (const auto& member : members_) {
    if (member->stand != Member::Stand::joined) continue;
    const std::string kind = Kind::of(member->lattice);
    auto at = std::find_if(groups_.begin(), groups_.end(),
                           [&](const auto& group) { return group->kind == kind; });
    if (at == groups_.end()) {
      groups_.push_back(std::make_unique<Group>(Group{.kind = kind, .members = {}, .engine = {}}));
      at = groups_.end() - 1;
    }
    member->group = at->get();
    member->run = (*at)->members.size();
    (*at)->members.push_back(member.get());
  }
  for (const auto& group : groups_) {
    std::vector<Lattice> lattices;
    for (Member* member : group->members) lattices.push_back(std::move(member->lattice));
    Answer word = Answer::good;
    Writer tiles;
    Bytes bytes;
    try {
      group->engine = make_(std::move(lattices));
      tiles(group->engine->tiles());
      bytes = tiles.bytes();
    } catch (const Failed& error) {
      word = Answer::failed, bytes = bytes_of(error.what());
    } catch (const InputError& error) {
      word = Answer::bad_input, bytes = bytes_of(error.what());
    }
    for (Member* member : group->members) {
      member->stand = Member::Stand::ready;
      member->reply(word, bytes);
      if (word != Answer::good) member->stand = Member::Stand::gone;
    }
  }
}

void Batch::launch_if_due(Group& group) {
  const auto stands = [&](Member::Stand where) {
    return std::any_of(group.members.begin(), group.members.end(),
                       [&](const Member* member) { return member->stand == where; });
  };
  if (stands(Member::Stand::ready) || !stands(Member::Stand::waiting)) return;
  std::vector<Steps> steps;
  int most = 0;
  for (Member* member : group.members) {
    most = std::max(most, member->steps.count);
    steps.push_back(std::exchange(member->steps, {}));
  }
  std::string why;
  try {
    group.engine->step(steps);
  } catch (const Failed& error) {
    why = error.what();
  }
  for (Member* member : group.members) {
    if (member->stand != Member::Stand::waiting) continue;
    member->why = why;
    member->stand = Member::Stand::ready;
  }
  ++launches_;
  steps_ += most;
}

namespace {

/// The engine of a batch as one of its runs sees it.
class EngineOfBatch final : public Engine {
 public:
  EngineOfBatch(int file, const Lattice& lattice) : connection_(file) {
    tiles_ = ask(Ask::join, lattice).get<std::int32_t>();
  }

  void put(std::size_t /*run*/, std::span<const double> records) override {
    (void)ask(Ask::put, records);
  }
  void get(std::size_t /*run*/, std::span<double> records) override { numbers(Ask::get, records); }
  void put_submerged(std::size_t /*run*/, std::span<const double> numbers) override {
    (void)ask(Ask::put_submerged, numbers);
  }
  void get_submerged(std::size_t /*run*/, std::span<double> values) override {
    numbers(Ask::get_submerged, values);
  }
  void put_damage(std::size_t /*run*/, const Damage& damage) override {
    (void)ask(Ask::put_damage, damage);
  }
  Damage get_damage(std::size_t /*run*/) override { return ask(Ask::get_damage).get<Damage>(); }
  void put_pairs(std::size_t /*run*/, Pairs pairs) override { (void)ask(Ask::put_pairs, pairs); }
  void get_pairs(std::size_t /*run*/, Pairs& pairs) override {
    pairs = ask(Ask::get_pairs).get<Pairs>();
  }
  bool list_pairs(std::size_t /*run*/, std::span<const double> obstacles) override {
    return ask(Ask::list_pairs, obstacles).get<bool>();
  }
  std::vector<Parted> get_parted(std::size_t /*run*/) override {
    return ask(Ask::get_parted).get<std::vector<Parted>>();
  }
  void put_worn(std::size_t /*run*/, std::span<const WornPlane> planes) override {
    (void)ask(Ask::put_worn, planes);
  }
  void put_obstacles(std::size_t /*run*/, std::span<const double> values) override {
    (void)ask(Ask::put_obstacles, values);
  }
  void get_obstacles(std::size_t /*run*/, std::span<double> values) override {
    numbers(Ask::get_obstacles, values);
  }
  void step(std::span<const Steps> steps) override { tell(Ask::step, steps.front()); }
  Made made(std::size_t /*run*/) override { return ask(Ask::made).get<Made>(); }
  Findings findings(std::size_t /*run*/) override { return ask(Ask::findings).get<Findings>(); }
  Works works(std::size_t /*run*/) override { return ask(Ask::works).get<Works>(); }
  void put_works(std::size_t /*run*/, const Works& works) override {
    (void)ask(Ask::put_works, works);
  }
  void forget_works(std::size_t /*run*/) override { (void)ask(Ask::forget_works); }
  std::int32_t tiles() const override { return tiles_; }

 private:
  [[noreturn]] static void refuse() {
    throw Failed("the process that makes the steps of a batch has ended");
  }
  template <class... Arguments>
  void tell(Ask word, const Arguments&... arguments) {
    Writer bytes;
    (bytes(arguments), ...);
    if (!connection_.send(static_cast<std::uint32_t>(word), bytes.bytes())) refuse();
  }
  template <class... Arguments>
  Reader ask(Ask word, const Arguments&... arguments) {
    tell(word, arguments...);
    std::optional<Message> reply = connection_.receive();
    if (!reply) refuse();
    const auto how = static_cast<Answer>(reply->word);
    if (how == Answer::bad_input) throw InputError(text_of(reply->bytes));
    if (how != Answer::good) throw Failed(text_of(reply->bytes));
    return Reader(std::move(reply->bytes));
  }
  void numbers(Ask word, std::span<double> values) {
    const auto got =
        ask(word, static_cast<std::uint64_t>(values.size())).get<std::vector<double>>();
    std::copy(got.begin(), got.end(), values.begin());
  }

  Connection connection_;
  std::int32_t tiles_ = 0;
};

}  // namespace

std::unique_ptr<Engine> join_batch(int file, const Lattice& lattice) {
  return std::make_unique<EngineOfBatch>(file, lattice);
}

bool is_socket(int file) {
  struct stat of {};
  return ::fstat(file, &of) == 0 && S_ISSOCK(of.st_mode);
}

std::optional<int> connection_to_batch() {
  const char* given = std::getenv(batch_variable);
  if (given == nullptr) return {};
  const std::string text = given;
  ::unsetenv(batch_variable);  // a connection joins once
  int file = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), file);
  if (error != std::errc{} || end != text.data() + text.size() || file < 0 || !is_socket(file) ||
      ::fcntl(file, F_SETFD, FD_CLOEXEC) < 0)
    throw InputError(std::string(batch_variable) + ": '" + text +
                     "' must be the number of an open connection (floe ensemble sets it)");
  return file;
}

}  // namespace floe::device
