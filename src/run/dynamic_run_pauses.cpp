// What a run in time does at a pause: it knows its forces, and keeps and goes back to states.
#include <algorithm>
#include <optional>

#include "base/collectives.h"
#include "base/on_root.h"
#include "run/dynamic_run.h"

namespace floe {
namespace {

/// A state in memory.
struct SavedRun final : RunState {
  mutable std::optional<Hdf5File> file;  ///< rank 0; reading changes the object
  std::vector<std::int32_t> owner;       ///< of each body
  std::int64_t looked = -1;
  std::size_t warnings = 0;

  Hdf5File* archive_file() const { return file ? &*file : nullptr; }
};

}  // namespace

/// Owner of each body. Collective.
template <class Space>
std::vector<std::int32_t> DynamicRun<Space>::owners() const {
  const Part& part = model_.part();
  std::vector<std::int32_t> mine(part.global.begin(), part.global.begin() + part.owned);
  std::vector<int> counts;
  const std::vector<std::int32_t> all = all_gathered(mine, part.comm, &counts);
  std::vector<std::int32_t> owner(all.size());
  std::size_t at = 0;
  for (std::size_t r = 0; r < counts.size(); ++r)
    for (int k = 0; k < counts[r]; ++k) item(owner, all[at++]) = static_cast<std::int32_t>(r);
  return owner;
}

template <class Space>
std::unique_ptr<const RunState> DynamicRun<Space>::save() {
  if (!can_go_back() || !options_.remake) return refuse_to_go_back();
  const MPI_Comm comm = model_.part().comm;
  auto saved = std::make_unique<SavedRun>();
  on_root(comm, [&] { saved->file.emplace(Hdf5File::in_memory()); });
  Archive archive(model_.part(), saved->archive_file(), Transfer::save);
  archive.stay_in_run();
  if (options_.supply) persist_ice(archive);
  persist(archive);
  share_outcome(archive.outcome(), comm);
  saved->owner = owners();
  saved->looked = looked_;
  saved->warnings = result_.warnings.size();
  return saved;
}

/// The forces are made anew: some cannot take back what has happened to them.
template <class Space>
void DynamicRun<Space>::restore(const RunState& state) {
  const auto* saved = dynamic_cast<const SavedRun*>(&state);
  if (saved == nullptr || !can_go_back() || !options_.remake) {
    (void)refuse_to_go_back();
    return;
  }
  Archive archive(model_.part(), saved->archive_file(), Transfer::load);
  archive.stay_in_run();
  if (options_.supply) persist_ice(archive);
  if (!options_.supply || owners() != saved->owner) {
    options_.remake(saved->owner);
    follow_division();
  }
  persist(archive);
  take_up_state();
  looked_ = saved->looked;
  result_.done = result_.stopped = false;
  result_.message.clear();
  why_.clear();
  result_.warnings.resize(std::min(saved->warnings, result_.warnings.size()));
  result_.dt = dt_;
  if (balance_) result_.moves = balance_->moves();
  count_steps();
  if (stand_ == Stand::ended) stand_ = Stand::running;
  check(TSSetTime(ts_, state_.time));
  check(TSSetTimeStep(ts_, dt_));
  known_ = -1;
  if (done_ == 0) begin_again(), known_ = 0;
}

template <class Space>
void DynamicRun<Space>::know_forces() {
  if (known_ == done_) return;
  evaluate();
  known_ = done_;
}

template <class Space>
void DynamicRun<Space>::forces_have_changed() {
  known_ = -1;
  if (done_ == 0 && can_go_back()) begin_again(), known_ = 0;
}

template <class Space>
std::vector<std::pair<std::string, double>> DynamicRun<Space>::columns_now() {
  know_forces();
  const auto [kinetic, boundary] = energies();
  const auto all = sum_over_ranks(std::array{kinetic, boundary}, model_.part().comm);
  auto columns = model_.report(state_, works());
  const Columns own = own_columns();
  for (const auto& [name, value] : own.values())
    columns.emplace_back(name, sum_over_ranks(value, model_.part().comm));
  columns.emplace_back("energy_kinetic", all[0]);
  columns.emplace_back("energy_boundary", all[1]);
  return columns;
}

template std::vector<std::int32_t> DynamicRun<Spatial>::owners() const;
template std::unique_ptr<const RunState> DynamicRun<Spatial>::save();
template void DynamicRun<Spatial>::restore(const RunState&);
template void DynamicRun<Spatial>::know_forces();
template void DynamicRun<Spatial>::forces_have_changed();
template std::vector<std::pair<std::string, double>> DynamicRun<Spatial>::columns_now();
template std::vector<std::int32_t> DynamicRun<Planar>::owners() const;
template std::unique_ptr<const RunState> DynamicRun<Planar>::save();
template void DynamicRun<Planar>::restore(const RunState&);
template void DynamicRun<Planar>::know_forces();
template void DynamicRun<Planar>::forces_have_changed();
template std::vector<std::pair<std::string, double>> DynamicRun<Planar>::columns_now();

}  // namespace floe
