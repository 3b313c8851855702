#include "lattice/archive.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {

void Archive::refuse(const std::string& why) const {
  throw InputError("checkpoint: restart: '" + name_ + "': " + why);
}

std::vector<double> Archive::read(const std::string& name, Within must, int columns) {
  std::vector<double> values;
  on_root(part_.comm, [&] { values = file_->read(name, columns); });
  broadcast(values, part_.comm);
  for (const double value : values) {
    if (value >= must.least && value <= must.most) continue;
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g", value);
    refuse(name + " has the value " + text.data() + ", which it cannot have");
  }
  return values;
}

/// Reads a dataset of one number.
std::vector<double> Archive::one(const std::string& name, Within must) {
  std::vector<double> values = read(name, must);
  if (values.size() != 1) refuse(name + " must be one number");
  return values;
}

void Archive::common(const std::string& name, std::vector<double>& values) {
  if (loading_) {
    values = read(group_ + name, finite);
  } else {
    write([&] { file_->write(group_ + name, values); });
  }
}

void Archive::common(const std::string& name, double& value, Within must) {
  if (loading_) {
    value = one(group_ + name, must)[0];
  } else {
    write([&] { file_->write(group_ + name, std::span<const double>(&value, 1)); });
  }
}

void Archive::common(const std::string& name, std::int64_t& value, std::int64_t least) {
  constexpr double most = 9007199254740992;  // 2^53, up to which doubles hold every integer
  auto number = static_cast<double>(value);
  common(name, number, {static_cast<double>(least), most});
  value = static_cast<std::int64_t>(number);
  if (static_cast<double>(value) != number) refuse(group_ + name + " must be an integer");
}

void Archive::common(const std::string& name, bool& value) {
  std::int64_t number = value ? 1 : 0;
  common(name, number);
  if (number > 1) refuse(group_ + name + " must be 0 or 1");
  value = number != 0;
}

void Archive::common(const std::string& name, std::string& text) {
  if (!loading_) {
    write([&] { file_->write_text(group_ + name, text); });
    return;
  }
  on_root(part_.comm, [&] { text = file_->read_text(group_ + name); });
  broadcast(text, part_.comm);
}

void Archive::share(const std::string& name, double& value) {
  const auto ranks = static_cast<std::size_t>(size(part_.comm));
  const int me = rank(part_.comm);
  if (!loading_) {
    const std::vector<double> all = gathered({&value, 1});
    write([&] { file_->write(group_ + name, all); });
    return;
  }
  const std::vector<double> all = read(group_ + name, finite);
  if (all.size() == ranks) {
    value = item(all, me);
  } else {
    value = me == 0 ? std::accumulate(all.begin(), all.end(), 0.0) : 0.0;
  }
}

/// Returns the numbers of all ranks on rank 0, in order of the ranks. Collective.
std::vector<double> Archive::gathered(std::span<const double> mine) const {
  const auto ranks = static_cast<std::size_t>(size(part_.comm));
  const int count = static_cast<int>(mine.size());
  std::vector<int> counts(ranks), offsets(ranks, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, part_.comm);
  for (std::size_t r = 1; r < ranks; ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  std::vector<double> all(
      static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0)));
  MPI_Gatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), offsets.data(), MPI_DOUBLE,
              0, part_.comm);
  return all;
}

namespace {

std::vector<std::int32_t> inverse(const std::vector<std::int32_t>& after, std::int64_t count) {
  std::vector<std::int32_t> before(static_cast<std::size_t>(count), -1);
  for (std::size_t k = 0; k < after.size(); ++k)
    if (after[k] >= 0) item(before, after[k]) = static_cast<std::int32_t>(k);
  return before;
}

void renumber(std::vector<double>& rows, std::size_t width,
              std::initializer_list<std::size_t> columns, const std::vector<std::int32_t>& after) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k + width <= rows.size(); k += width) {
    bool stays = true;
    for (const std::size_t c : columns) {
      double& index = rows[k + c];
      if (index < 0) continue;
      index = item(after, static_cast<std::int32_t>(index));
      stays = stays && index >= 0;
    }
    if (!stays) continue;
    std::copy_n(&rows[k], width, &rows[kept]);
    kept += width;
  }
  rows.resize(kept);
}

}  // namespace

void Archive::renumber(const Renumbering& how) {
  renumbering_ = &how;
  bodies_before_ = inverse(how.bodies, part_.global_bodies);
  beams_before_ = inverse(how.beams, part_.global_beams);
}

void Archive::renumber_bodies(std::vector<double>& rows, std::size_t width,
                              std::initializer_list<std::size_t> columns) const {
  if (renumbers() && loading_) floe::renumber(rows, width, columns, renumbering_->bodies);
}

void Archive::renumber_beams(std::vector<double>& rows, std::size_t width) const {
  if (renumbers() && loading_) floe::renumber(rows, width, {0}, renumbering_->beams);
}

void Archive::rows(const std::string& name, std::span<const std::int32_t> names,
                   const std::vector<std::int32_t>& before, std::span<const std::int32_t> local,
                   std::span<double> rows, int width) {
  std::vector<std::int32_t> global;
  global.reserve(local.size());
  for (const std::int32_t k : local)
    global.push_back(renumbers() ? item(before, item(names, k)) : item(names, k));
  if (!loading_) {
    save_rows(name, global, rows, width);
    return;
  }
  const auto w = static_cast<std::size_t>(width);
  const std::vector<double> listed = read(group_ + name + "_bodies", not_negative),
                            values = read(group_ + name, finite, width);
  bool all_there = values.size() == listed.size() * w;
  for (std::size_t k = 0; k < global.size() && all_there; ++k) {
    if (global[k] < 0) continue;  // has joined
    const auto at = static_cast<std::size_t>(
        std::lower_bound(listed.begin(), listed.end(), static_cast<double>(global[k])) -
        listed.begin());
    all_there = at < listed.size() && listed[at] == static_cast<double>(global[k]);
    if (all_there) std::copy_n(&values[at * w], w, &rows[k * w]);
  }
  if (!on_all_ranks(all_there, part_.comm))
    refuse(group_ + name + " is of another lattice than this scene's");
}

void Archive::save_rows(const std::string& name, const std::vector<std::int32_t>& global,
                        std::span<const double> rows, int width) {
  const auto w = static_cast<std::size_t>(width);
  const std::vector<double> mine(global.begin(), global.end());
  const std::vector<double> bodies = gathered(mine), values = gathered(rows);
  if (file_ == nullptr) return;
  std::vector<std::size_t> order(bodies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return bodies[a] < bodies[b]; });
  std::vector<std::int32_t> sorted;
  std::vector<double> ordered;
  sorted.reserve(order.size());
  ordered.reserve(values.size());
  for (const std::size_t k : order) {
    sorted.push_back(static_cast<std::int32_t>(bodies[k]));
    ordered.insert(ordered.end(), &values[k * w], &values[k * w] + w);
  }
  write([&] {
    file_->write(group_ + name + "_bodies", sorted);
    file_->write(group_ + name, ordered, width);
  });
}

}  // namespace floe
