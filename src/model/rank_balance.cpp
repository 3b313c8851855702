#include "model/rank_balance.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/collectives.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

// Measured with input/ice_slope.yaml on AVX-512:
constexpr double ns_of_body = 60;  ///< motion, weight and water of a body in a step
constexpr double us_of_move = 60;  ///< a move, per body of the lattice

double mean_of(const std::vector<double>& loads) {
  return std::accumulate(loads.begin(), loads.end(), 0.0) / static_cast<double>(loads.size());
}
double largest_of(const std::vector<double>& loads) {
  return *std::max_element(loads.begin(), loads.end());
}

/// Places and loads of all bodies of a lattice.
struct Everywhere {
  std::vector<Point3> places;
  std::vector<double> loads;
};

/// Gathers them on all ranks. Collective.
template <class Space>
Everywhere gathered(const Model<Space>& model, const State<Space>& state,
                    const std::vector<double>& loads) {
  constexpr std::size_t width = 5;
  const Part& part = model.part();
  std::vector<double> mine;
  mine.reserve(width * loads.size());
  for (std::size_t b = 0; b < loads.size(); ++b) {
    const Vec3<double> place = part.bodies.position[b] + displacement(state, b);
    mine.insert(mine.end(),
                {static_cast<double>(part.global[b]), place.x, place.y, place.z, loads[b]});
  }
  const std::vector<double> rows = all_gathered(mine, part.comm);
  const auto bodies = static_cast<std::size_t>(part.global_bodies);
  Everywhere all{std::vector<Point3>(bodies), std::vector<double>(bodies)};
  for (std::size_t k = 0; k < rows.size(); k += width) {
    const auto b = static_cast<std::size_t>(rows[k]);
    all.places[b] = {rows[k + 1], rows[k + 2], rows[k + 3]};
    all.loads[b] = rows[k + 4];
  }
  return all;
}

}  // namespace

template <class Space>
std::vector<double> loads_of(const Model<Space>& model, const State<Space>& state) {
  std::vector<double> loads(static_cast<std::size_t>(model.part().owned), ns_of_body);
  for (const auto& force : model.forces()) {
    if (const auto* role = force->roles().load) role->add_load(state, loads);
  }
  return loads;
}

std::int64_t RankBalance::next_look(std::int64_t step) const {
  if (!is_on()) return std::numeric_limits<std::int64_t>::max();
  return (step / options_.every + 1) * options_.every;
}

/// Adds the time that ranks have waited since the last look. Whether bodies should move if a better
/// division exists.
bool RankBalance::is_worth(const std::vector<double>& loads, std::int64_t bodies) {
  const double mean = mean_of(loads), most = largest_of(loads);
  waited_ += 1e-9 * (most - mean) * static_cast<double>(options_.every);
  return options_.threshold == 1 || (most > options_.threshold * mean &&
                                     waited_ > 1e-6 * us_of_move * static_cast<double>(bodies));
}

template <class Space>
std::optional<std::vector<std::int32_t>> RankBalance::look(const Model<Space>& model,
                                                           const State<Space>& state) {
  const Part& part = model.part();
  const std::vector<double> mine = loads_of(model, state);
  const std::vector<double> loads =
      all_gathered(std::vector{std::accumulate(mine.begin(), mine.end(), 0.0)}, part.comm);
  if (!is_worth(loads, part.global_bodies)) return {};
  waited_ = 0;
  const Everywhere all = gathered(model, state, mine);
  std::vector<std::int32_t> owner =
      owners_by_load(all.places, all.loads, size(part.comm), options_.strips);
  std::vector<double> after(loads.size(), 0.0);
  for (std::size_t b = 0; b < owner.size(); ++b) item(after, owner[b]) += all.loads[b];
  const double mean = mean_of(loads), before = largest_of(loads);
  if (options_.threshold > 1 && largest_of(after) > 0.5 * (before + mean)) return {};
  ++moves_.count;
  moves_.before = before / mean;
  moves_.after = largest_of(after) / mean;
  owner_ = owner;
  return owner;
}

void RankBalance::persist(Archive& archive, MPI_Comm comm) {
  std::int64_t ranks = size(comm);
  std::vector<double> numbers(owner_.begin(), owner_.end());
  archive.common("ranks", ranks, 1);
  archive.common("owner", numbers);
  archive.common("waited", waited_, not_negative);
  archive.common("moves", moves_.count);
  archive.common("load_before", moves_.before, not_negative);
  archive.common("load_after", moves_.after, not_negative);
  if (!archive.loading()) return;
  owner_.assign(numbers.begin(), numbers.end());
  if (ranks == size(comm)) return;
  owner_.clear();
  waited_ = 0;
}

template std::vector<double> loads_of(const Model<Spatial>&, const State<Spatial>&);
template std::vector<double> loads_of(const Model<Planar>&, const State<Planar>&);
template std::optional<std::vector<std::int32_t>> RankBalance::look(const Model<Spatial>&,
                                                                    const State<Spatial>&);
template std::optional<std::vector<std::int32_t>> RankBalance::look(const Model<Planar>&,
                                                                    const State<Planar>&);

}  // namespace floe
