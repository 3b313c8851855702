/// \file
/// The engine of a back end, over the layer of launch.h. Each back end compiles this text by
/// itself.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "device/contact_store.h"
#include "device/engine.h"
#include "device/launch.h"
#include "device/move_step.h"
#include "device/tile_step.h"
#include "device/tiles.h"
#include "device/water_step.h"

namespace floe::device {
namespace {

/// Most bodies of a tile: small lattices need many tiles to fill a device, large ones few beams
/// that two tiles compute.
inline std::int32_t tile_for(std::int64_t bodies) {
  constexpr std::int64_t small = 8'000, large = 200'000;
  return bodies < small ? 32 : bodies < large ? 64 : 128;
}

template <bool damped, bool breakable, template <class> class Frame>
class TileEngine final : public Engine {
  using Step = TileStep<damped, breakable, Frame>;

 public:
  TileEngine(std::vector<Lattice> lattices, std::int32_t tile) : lattices_(std::move(lattices)) {
    for (const Lattice& lattice : lattices_) {
      first_body_.push_back(first_body_.back() + lattice.bodies);
      first_beam_.push_back(first_beam_.back() + static_cast<std::int32_t>(lattice.ends.size()));
      first_held_.push_back(first_held_.back() + lattice.held.size());
      first_loaded_.push_back(first_loaded_.back() + lattice.loaded.size());
      first_support_.push_back(first_support_.back() + lattice.supports.size());
    }
    const auto bodies = static_cast<std::size_t>(first_body_.back());
    if (tile == 0) tile = tile_for(first_body_.back());
    if (tile < 1 || tile > most_threads) throw Failed("a tile has 1 to 128 bodies");
    constexpr std::size_t usual = 48U << 10;  // of shared memory that any device gives [bytes]
    tiles_ = make_tiles(lattices_, tile,
                        static_cast<std::int32_t>(usual / (sizeof(double) * Step::shares)));
    first_slot_of_run_.assign(lattices_.size() + 1, 0);
    for (std::size_t t = 0; t < tiles_.run.size(); ++t)
      first_slot_of_run_[static_cast<std::size_t>(tiles_.run[t]) + 1] =
          static_cast<std::size_t>(tiles_.first_slot[t + 1]);
    for (std::size_t r = 0; r < lattices_.size(); ++r)  // runs without bodies have no tile
      first_slot_of_run_[r + 1] = std::max(first_slot_of_run_[r + 1], first_slot_of_run_[r]);
    shared_ = sizeof(double) * Step::shares * static_cast<std::size_t>(tiles_.most_slots);

    first_body_of_tile_ = keep(tiles_.first_body);
    first_slot_ = keep(tiles_.first_slot);
    run_ = keep(tiles_.run);
    i_ = keep(tiles_.i);
    j_ = keep(tiles_.j);
    first_end_ = keep(tiles_.first_end);
    ends_ = keep(tiles_.ends);
    take_beams();
    take_bodies(bodies);
    take_held(bodies);
    take_loads(bodies);
    take_supports(bodies);
    take_water(bodies);
    if constexpr (breakable) take_breaking();
    contacts_.take(lattices_, first_body_);
    for (auto& records : records_) records = Array<double>(of_record * bodies);
    if (damped) beam_works_ = Array<double>(bodies);
    speed2_ = Array<std::uint64_t>(lattices_.size());
    spin2_ = Array<std::uint64_t>(lattices_.size());
    runs_ = Array<RunOfTiles>(lattices_.size());
    last_ = Array<std::int32_t>(lattices_.size());
    made_.resize(lattices_.size());
    found_.resize(lattices_.size());
    why_ = Array<std::uint32_t>(lattices_.size());
  }

  void put(std::size_t run, std::span<const double> records) override {
    queue_.wait();
    put_numbers(records_[now_], of_record, run, records);
  }
  void get(std::size_t run, std::span<double> records) override {
    queue_.wait();
    get_numbers(records_[now_], of_record, run, records);
  }
  void put_submerged(std::size_t run, std::span<const double> numbers) override {
    queue_.wait();
    put_numbers(expansions_, of_expansion, run, numbers);
  }
  void get_submerged(std::size_t run, std::span<double> numbers) override {
    queue_.wait();
    get_numbers(expansions_, of_expansion, run, numbers);
  }

  void put_damage(std::size_t run, const Damage& damage) override {
    if constexpr (breakable) {
      queue_.wait();
      put_of_beams(cracks_, Damage::numbers, run, damage.cracks);
      if (!damage.viscous.empty()) put_of_beams(viscous_, of_viscous, run, damage.viscous);
      const std::uint64_t none = 0;
      grown_.put({&none, 1}, run);
    }
  }
  Damage get_damage(std::size_t run) override {
    Damage damage;
    if constexpr (breakable) {
      queue_.wait();
      std::uint64_t grown = 0;
      grown_.get({&grown, 1}, run);
      if (grown != 0) damage.cracks = get_of_beams(cracks_, Damage::numbers, run);
      if (lattices_[run].damped) damage.viscous = get_of_beams(viscous_, of_viscous, run);
    }
    return damage;
  }

  void put_pairs(std::size_t run, Pairs pairs) override {
    queue_.wait();
    if (contacts_.put_pairs(run, std::move(pairs), records_[now_])) queue_.forget();
  }
  void get_pairs(std::size_t run, Pairs& pairs) override {
    queue_.wait();
    contacts_.get_pairs(run, pairs);
  }
  bool list_pairs(std::size_t run, std::span<const double> obstacles) override {
    queue_.wait();
    const auto bodies = static_cast<std::int64_t>(first_body_.back());
    return contacts_.list_pairs(run, obstacles, records_[now_], {bodies_.data(), bodies}, queue_);
  }
  std::vector<Parted> get_parted(std::size_t run) override {
    queue_.wait();
    return contacts_.get_parted(run);
  }
  void put_worn(std::size_t run, std::span<const WornPlane> planes) override {
    queue_.wait();
    contacts_.put_worn(run, planes);
  }
  void put_obstacles(std::size_t run, std::span<const double> numbers) override {
    queue_.wait();
    contacts_.put_obstacles(run, numbers);
  }
  void get_obstacles(std::size_t run, std::span<double> numbers) override {
    queue_.wait();
    contacts_.get_obstacles(run, numbers);
  }

  void step(std::span<const Steps> steps) override {
    int most = 0;
    std::vector<RunOfTiles> runs;
    std::vector<std::int32_t> last;
    std::vector<double> motions, wrenches, water_motions;
    std::vector<WaterOfRun> waters;
    std::vector<BreakingOfRun> breaking;
    std::vector<double> times;
    for (std::size_t r = 0; r < lattices_.size(); ++r) {
      const Steps& of = steps[r];
      most = std::max(most, of.count);
      last.push_back(of.count - 1);
      runs.push_back({of.dt, of.before, static_cast<std::int64_t>(motions.size()),
                      lattices_[r].motions, static_cast<std::int64_t>(wrenches.size()),
                      lattices_[r].loads});
      motions.insert(motions.end(), of.motions.begin(), of.motions.end());
      wrenches.insert(wrenches.end(), of.wrenches.begin(), of.wrenches.end());
      if constexpr (breakable) {
        const Breaking none, &b = lattices_[r].breaking ? *lattices_[r].breaking : none;
        breaking.push_back({b.general ? 1 : 0, b.crushes ? 1 : 0,
                            lattices_[r].halts_at_breaks ? 1 : 0,
                            static_cast<std::int64_t>(times.size())});
        times.insert(times.end(), of.times.begin(), of.times.end());
      }
      if (!has_water_) continue;
      const Water none, &w = lattices_[r].water ? *lattices_[r].water : none;
      waters.push_back({w.weight_density, w.linear, w.coefficient, w.drags ? 1 : 0, w.pace,
                        of.since, w.by_points ? 1 : 0,
                        static_cast<std::int64_t>(water_motions.size())});
      water_motions.insert(water_motions.end(), of.water.begin(), of.water.end());
      if (!lattices_[r].water)
        water_motions.resize(water_motions.size() + 4 * static_cast<std::size_t>(of.count));
    }
    queue_.wait();
    has_looked_ = false;
    last_.put(last);
    why_.put(std::vector<std::uint32_t>(lattices_.size()));
    if (most == 0 || tiles_.run.empty()) return;
    bool grown = give(motions, motions_);
    grown = give(wrenches, wrenches_) || grown;
    grown = give(water_motions, water_motions_) || grown;
    grown = give(times, times_) || grown;
    if (contacts_.any()) grown = contacts_.put_steps(steps) || grown;
    if (grown) queue_.forget();
    runs_.put(runs);
    breaking_.put(breaking);
    waters_.put(waters);
    const Memory memory = all();
    const WaterMemory water = all_of_water();
    const auto key = static_cast<std::uint64_t>(most) << 1U | now_;
    const int parity = static_cast<int>(now_);
    const auto tiles = static_cast<std::int32_t>(tiles_.run.size());
    constexpr int warp = 32;
    const int threads = std::max(warp, (tiles_.most_bodies + warp - 1) / warp * warp);
    queue_.run(key, [&](const auto& launch) {
      Memory of_step = memory;
      if (parity == 1) std::swap(of_step.records[0], of_step.records[1]);
      for (int k = 0; k < most; ++k) {
        if (has_water_) launch(WaterStep{of_step, water, k}, tiles, threads, 0);
        if (contacts_.room() > 0) {
          launch(OverlapStep<Memory>{of_step, k}, contacts_.room(), threads, 0);
          launch(TrialStep<Memory>{of_step, k}, contacts_.blocks(), most_threads, 0);
        }
        launch(Step{of_step, k}, tiles, threads, shared_);
        if (!contacts_.any()) continue;
        if (contacts_.room() > 0 && contacts_.damps()) {
          launch(PredictStep{of_step, k}, tiles, threads, 0);
          launch(DashpotStep<Memory>{of_step, k}, contacts_.blocks(), most_threads, 0);
        }
        if (contacts_.obstacles() > 0)
          launch(ObstacleStep<Memory>{of_step, k}, static_cast<std::int32_t>(contacts_.obstacles()),
                 most_threads, 0);
        launch(MoveStep{of_step, k}, tiles, threads, 0);
      }
    });
    now_ = (now_ + static_cast<std::size_t>(most)) % 2;
  }

  Made made(std::size_t run) override {
    look();
    return made_[run];
  }
  Findings findings(std::size_t run) override {
    look();
    const auto [speed2, spin2] = std::exchange(found_[run], {});
    return {std::bit_cast<double>(speed2), std::bit_cast<double>(spin2)};
  }

  Works works(std::size_t run) override {
    queue_.wait();
    const auto take = [](Array<double>& works, std::size_t first, std::size_t end) {
      std::vector<double> values(works.size() == 0 ? 0 : end - first);
      works.get(values, first);
      return values;
    };
    const auto body = [&](std::size_t r) { return static_cast<std::size_t>(first_body_[r]); };
    Works works{take(beam_works_, body(run), body(run + 1)),
                take(held_works_, first_held_[run], first_held_[run + 1]),
                take(load_works_, first_loaded_[run], first_loaded_[run + 1]),
                take(support_works_, first_support_[run], first_support_[run + 1]),
                take(drag_works_, body(run), body(run + 1)),
                take(buoyancy_works_, body(run), body(run + 1)),
                {},
                {}};
    contacts_.add_works(run, works);
    return works;
  }

  void put_works(std::size_t run, const Works& works) override {
    queue_.wait();
    const auto put = [](Array<double>& memory, const std::vector<double>& values, auto first) {
      if (memory.size() > 0) memory.put(values, static_cast<std::size_t>(first));
    };
    put(beam_works_, works.beams, first_body_[run]);
    put(held_works_, works.held, first_held_[run]);
    put(load_works_, works.loaded, first_loaded_[run]);
    put(support_works_, works.supports, first_support_[run]);
    put(drag_works_, works.drag, first_body_[run]);
    put(buoyancy_works_, works.buoyancy, first_body_[run]);
    contacts_.put_works(run, works);
  }

  void forget_works(std::size_t run) override {
    queue_.wait();
    const auto forget = [](Array<double>& works, std::size_t first, std::size_t end) {
      if (works.size() > 0) works.put(std::vector<double>(end - first), first);
    };
    const auto first = static_cast<std::size_t>(first_body_[run]),
               end = static_cast<std::size_t>(first_body_[run + 1]);
    for (auto* works : {&beam_works_, &drag_works_, &buoyancy_works_}) forget(*works, first, end);
    forget(held_works_, first_held_[run], first_held_[run + 1]);
    forget(load_works_, first_loaded_[run], first_loaded_[run + 1]);
    forget(support_works_, first_support_[run], first_support_[run + 1]);
    contacts_.forget_works(run);
  }

  std::int32_t tiles() const override { return static_cast<std::int32_t>(tiles_.run.size()); }

 private:
  /// Brings what the steps since the last look have done, of all runs at once.
  void look() {
    queue_.wait();
    if (has_looked_) return;
    has_looked_ = true;
    const std::size_t runs = lattices_.size();
    std::vector<std::int32_t> last(runs);
    std::vector<std::uint32_t> why(runs);
    last_.get(last);
    why_.get(why);
    for (std::size_t r = 0; r < runs; ++r) made_[r] = {last[r] + 1, why[r]};
    for (const std::size_t k : {0U, 1U}) {
      Array<std::uint64_t>& largest = k == 0 ? speed2_ : spin2_;
      std::vector<std::uint64_t> bits(runs);
      largest.get(bits);
      largest.put(std::vector<std::uint64_t>(runs));
      for (std::size_t r = 0; r < runs; ++r) found_[r][k] = std::max(found_[r][k], bits[r]);
    }
  }

  template <class T>
  static Array<T> keep(const std::vector<T>& values) {
    return Array<T>(std::span<const T>(values));
  }
  std::size_t bodies_of(std::size_t run) const {
    return static_cast<std::size_t>(lattices_[run].bodies);
  }
  /// Copies numbers of a run's bodies, body after body, into memory that has them number by number.
  void put_numbers(Array<double>& memory, int count, std::size_t run,
                   std::span<const double> numbers) {
    const std::size_t bodies = bodies_of(run), of_body = static_cast<std::size_t>(count);
    room_.resize(bodies);
    for (int n = 0; n < count; ++n) {
      for (std::size_t b = 0; b < bodies; ++b)
        room_[b] = numbers[b * of_body + static_cast<std::size_t>(n)];
      memory.put(std::span<const double>(room_), place(n, run));
    }
  }
  void get_numbers(Array<double>& memory, int count, std::size_t run, std::span<double> numbers) {
    const std::size_t bodies = bodies_of(run), of_body = static_cast<std::size_t>(count);
    room_.resize(bodies);
    for (int n = 0; n < count; ++n) {
      memory.get(std::span<double>(room_), place(n, run));
      for (std::size_t b = 0; b < bodies; ++b)
        numbers[b * of_body + static_cast<std::size_t>(n)] = room_[b];
    }
  }
  std::size_t place(int number, std::size_t run) const {
    return static_cast<std::size_t>(number * static_cast<std::int64_t>(first_body_.back()) +
                                    first_body_[run]);
  }

  void take_beams() {
    const std::size_t slots = tiles_.beam.size();
    std::vector<const std::array<double, Lattice::of_beam>*> beams;
    for (const Lattice& lattice : lattices_) {
      for (const auto& beam : lattice.beams) beams.push_back(&beam);
    }
    constexpr auto frame = static_cast<std::size_t>(Step::first);
    std::vector<double> constants(slots * static_cast<std::size_t>(Step::of_beam));
    for (std::size_t s = 0; s < slots; ++s) {
      const auto& of = *beams[static_cast<std::size_t>(tiles_.beam[s])];
      constexpr std::size_t length = 15;
      for (std::size_t n = 0; n < frame; ++n) constants[n * slots + s] = of[n];
      for (std::size_t n = frame; n < static_cast<std::size_t>(Step::of_beam); ++n)
        constants[n * slots + s] = of[length + n - frame];
    }
    constants_ = keep(constants);
  }

  void take_breaking() {
    const std::size_t slots = tiles_.beam.size();
    std::vector<double> constants(slots * Breaking::numbers), limits(slots);
    slot_of_.resize(static_cast<std::size_t>(first_beam_.back()));
    for (std::size_t r = 0; r < lattices_.size(); ++r) {
      const auto& of = lattices_[r].breaking;
      for_slots(r, [&](std::size_t s, std::size_t m) {
        slot_of_[static_cast<std::size_t>(first_beam_[r]) + m] = s;  // one of two, which are alike
        limits[s] = of ? of->limits[m] : std::numeric_limits<double>::infinity();
        for (std::size_t n = 0; of && n < Breaking::numbers; ++n)
          constants[n * slots + s] = of->beams[m][n];
      });
    }
    breakable_ = keep(constants);
    limits_ = keep(limits);
    cracks_ = Array<double>(slots * Damage::numbers);
    if (damped) viscous_ = Array<float>(slots * of_viscous);
    grown_ = Array<std::uint64_t>(lattices_.size());
    breaking_ = Array<BreakingOfRun>(lattices_.size());
  }
  /// Calls visit(slot, beam of the run) for the slots of a run.
  template <class Visit>
  void for_slots(std::size_t run, const Visit& visit) const {
    for (std::size_t s = first_slot_of_run_[run]; s < first_slot_of_run_[run + 1]; ++s)
      visit(s, static_cast<std::size_t>(tiles_.beam[s] - first_beam_[run]));
  }
  /// Copies numbers of a run's beams, beam after beam, into memory that has them slot by slot.
  template <class T>
  void put_of_beams(Array<T>& memory, std::size_t count, std::size_t run,
                    const std::vector<T>& numbers) {
    const std::size_t first = first_slot_of_run_[run];
    std::vector<T> row(first_slot_of_run_[run + 1] - first);
    for (std::size_t n = 0; n < count; ++n) {
      for_slots(run,
                [&](std::size_t s, std::size_t m) { row[s - first] = numbers[m * count + n]; });
      memory.put(std::span<const T>(row), n * tiles_.beam.size() + first);
    }
  }
  template <class T>
  std::vector<T> get_of_beams(const Array<T>& memory, std::size_t count, std::size_t run) const {
    const std::size_t first = first_slot_of_run_[run], beams = lattices_[run].ends.size();
    std::vector<T> row(first_slot_of_run_[run + 1] - first), numbers(beams * count);
    for (std::size_t n = 0; n < count; ++n) {
      memory.get(std::span<T>(row), n * tiles_.beam.size() + first);
      for (std::size_t m = 0; m < beams; ++m)
        numbers[m * count + n] =
            row[slot_of_[static_cast<std::size_t>(first_beam_[run]) + m] - first];
    }
    return numbers;
  }

  void take_bodies(std::size_t bodies) {
    std::vector<double> constants(8 * bodies), weights;
    std::size_t b = 0;
    for (const Lattice& lattice : lattices_) {
      for (const auto& of : lattice.constants) {
        for (std::size_t n = 0; n < of.size(); ++n) constants[n * bodies + b] = of[n];
        ++b;
      }
    }
    bodies_ = keep(constants);
    if (std::all_of(lattices_.begin(), lattices_.end(),
                    [](const Lattice& l) { return l.weights.empty(); }))
      return;
    for (const Lattice& lattice : lattices_) {
      std::vector<double> of = lattice.weights;
      of.resize(static_cast<std::size_t>(lattice.bodies));
      weights.insert(weights.end(), of.begin(), of.end());
    }
    weights_ = keep(weights);
  }

  void take_held(std::size_t bodies) {
    if (first_held_.back() == 0) return;
    std::vector<std::int32_t> rows(bodies, -1), motions;
    std::vector<std::uint8_t> bits;
    for (std::size_t r = 0; r < lattices_.size(); ++r) {
      for (const Lattice::Held& held : lattices_[r].held) {
        rows[static_cast<std::size_t>(first_body_[r] + held.body)] =
            static_cast<std::int32_t>(bits.size());
        bits.push_back(held.bits);
        motions.insert(motions.end(), held.motions.begin(), held.motions.end());
      }
    }
    held_row_ = keep(rows);
    held_bits_ = keep(bits);
    held_motions_ = keep(motions);
    held_works_ = Array<double>(bits.size());
  }

  void take_loads(std::size_t bodies) {
    const std::size_t all = first_loaded_.back();
    if (all == 0) return;
    std::vector<std::int32_t> first(bodies + 1), load;
    std::vector<double> arms(3 * all);
    for (std::size_t r = 0; r < lattices_.size(); ++r) {
      for (const Lattice::Loaded& one : lattices_[r].loaded) {
        for (std::size_t n = 0; n < 3; ++n) arms[n * all + load.size()] = one.arm[n];
        load.push_back(one.load);
        ++first[static_cast<std::size_t>(first_body_[r] + one.body) + 1];
      }
    }
    for (std::size_t b = 0; b < bodies; ++b) first[b + 1] += first[b];
    first_load_ = keep(first);
    load_ = keep(load);
    arms_ = keep(arms);
    load_works_ = Array<double>(all);
  }

  void take_supports(std::size_t bodies) {
    if (first_support_.back() == 0) return;
    std::vector<std::int32_t> of(bodies, -1);
    std::vector<double> numbers;
    std::int32_t next = 0;
    for (std::size_t r = 0; r < lattices_.size(); ++r) {
      for (const Lattice::Supported& one : lattices_[r].supports) {
        of[static_cast<std::size_t>(first_body_[r] + one.body)] = next++;
        numbers.insert(numbers.end(), one.arm.begin(), one.arm.end());
        numbers.insert(numbers.end(), one.stiffness.begin(), one.stiffness.end());
        numbers.insert(numbers.end(), one.damping.begin(), one.damping.end());
      }
    }
    support_of_ = keep(of);
    supports_ = keep(numbers);
    support_works_ = Array<double>(first_support_.back());
  }

  /// What the water needs. Runs without water, beside others with it, have bodies without shape.
  void take_water(std::size_t bodies) {
    has_water_ = std::any_of(lattices_.begin(), lattices_.end(),
                             [](const Lattice& lattice) { return lattice.water.has_value(); });
    if (!has_water_) return;
    constexpr std::size_t of_prism = 14, of_whole = 4;
    std::vector<double> prisms(of_prism * bodies), wholes(of_whole * bodies), extents, most2,
        area_per_volume, vertices;
    std::vector<std::int32_t> first_vertex{0}, first_face{0}, first_corner{0}, corners;
    bool drags = false, level_moves = false, has_pace = false;
    for (std::size_t r = 0; r < lattices_.size(); ++r) {
      const auto first = static_cast<std::size_t>(first_body_[r]);
      const std::size_t count = bodies_of(r);
      const Water none, &w = lattices_[r].water ? *lattices_[r].water : none;
      drags = drags || w.drags;
      level_moves = level_moves || w.level_moves;
      has_pace = has_pace || w.pace > 1;
      for (std::size_t b = 0; b < w.prisms.size(); ++b) {
        for (std::size_t n = 0; n < of_prism; ++n) prisms[n * bodies + first + b] = w.prisms[b][n];
        for (std::size_t n = 0; n < of_whole; ++n) wholes[n * bodies + first + b] = w.wholes[b][n];
      }
      const auto append = [&](std::vector<double>& to, std::vector<double> values) {
        values.resize(count);
        to.insert(to.end(), values.begin(), values.end());
      };
      append(extents, w.extents);
      append(most2, w.most2);
      append(area_per_volume, w.area_per_volume);
      const auto vertices_before = static_cast<std::int32_t>(vertices.size() / 3),
                 faces_before = static_cast<std::int32_t>(first_corner.size()) - 1,
                 corners_before = static_cast<std::int32_t>(corners.size());
      for (std::size_t b = 1; b <= count; ++b) {
        first_vertex.push_back(vertices_before +
                               (b < w.first_vertex.size() ? w.first_vertex[b] : 0));
        first_face.push_back(faces_before + (b < w.first_face.size() ? w.first_face[b] : 0));
      }
      for (std::size_t f = 1; f < w.first_corner.size(); ++f)
        first_corner.push_back(corners_before + w.first_corner[f]);
      for (const std::int32_t v : w.corners) corners.push_back(vertices_before + v);
      for (const auto& vertex : w.vertices)
        vertices.insert(vertices.end(), vertex.begin(), vertex.end());
    }
    prisms_ = keep(prisms);
    wholes_ = keep(wholes);
    extents_ = keep(extents);
    most2_ = keep(most2);
    area_per_volume_ = keep(area_per_volume);
    first_vertex_ = keep(first_vertex);
    first_face_ = keep(first_face);
    first_corner_ = keep(first_corner);
    corners_ = keep(corners);
    vertices_ = keep(vertices);
    waters_ = Array<WaterOfRun>(lattices_.size());
    constexpr std::size_t of_water = 6;
    water_forces_ = Array<double>(of_water * bodies);
    if (drags) drag_works_ = Array<double>(bodies);
    if (level_moves) buoyancy_works_ = Array<double>(bodies);
    if (has_pace) expansions_ = Array<double>(of_expansion * bodies);
  }

  /// Hands over a table, in memory that is made larger where that must be. Returns
  /// whether it was made larger.
  static bool give(const std::vector<double>& values, Array<double>& memory) {
    const bool larger = values.size() > memory.size();
    if (larger) memory = Array<double>(2 * values.size());
    memory.put(values);
    return larger;
  }

  template <class T>
  static T* or_null(Array<T>& array) {
    return array.size() == 0 ? nullptr : array.data();
  }
  Memory all() {
    const auto bodies = static_cast<std::int64_t>(first_body_.back()),
               slots = static_cast<std::int64_t>(tiles_.beam.size());
    return {first_body_of_tile_.data(),
            first_slot_.data(),
            run_.data(),
            i_.data(),
            j_.data(),
            {constants_.data(), slots},
            first_end_.data(),
            ends_.data(),
            {bodies_.data(), bodies},
            or_null(weights_),
            {{records_[0].data(), bodies}, {records_[1].data(), bodies}},
            or_null(beam_works_),
            {or_null(water_forces_), bodies},
            or_null(drag_works_),
            or_null(buoyancy_works_),
            or_null(held_row_),
            held_bits_.data(),
            held_motions_.data(),
            held_works_.data(),
            motions_.data(),
            or_null(first_load_),
            load_.data(),
            {arms_.data(), static_cast<std::int64_t>(first_loaded_.back())},
            load_works_.data(),
            wrenches_.data(),
            or_null(support_of_),
            supports_.data(),
            support_works_.data(),
            runs_.data(),
            {last_.data(), why_.data()},
            speed2_.data(),
            spin2_.data(),
            {breaking_.data(),
             times_.data(),
             limits_.data(),
             {breakable_.data(), slots},
             {cracks_.data(), slots},
             {or_null(viscous_), slots},
             grown_.data(),
             {last_.data(), why_.data()}},
            contacts_.memory()};
  }

  WaterMemory all_of_water() {
    const auto bodies = static_cast<std::int64_t>(first_body_.back());
    return {waters_.data(),
            water_motions_.data(),
            {prisms_.data(), bodies},
            {wholes_.data(), bodies},
            extents_.data(),
            most2_.data(),
            area_per_volume_.data(),
            first_vertex_.data(),
            first_face_.data(),
            first_corner_.data(),
            corners_.data(),
            vertices_.data(),
            {or_null(expansions_), bodies}};
  }

  std::vector<Lattice> lattices_;
  std::vector<std::int32_t> first_body_{0}, first_beam_{0};
  std::vector<std::size_t> first_held_{0}, first_loaded_{0}, first_support_{0};
  Tiles tiles_;
  std::size_t shared_ = 0, now_ = 0;
  Queue queue_;
  Array<std::int32_t> first_body_of_tile_, first_slot_, run_, i_, j_, first_end_, ends_;
  Array<double> constants_, bodies_, weights_, beam_works_, held_works_, motions_, arms_,
      load_works_, wrenches_, supports_, support_works_;
  Array<std::int32_t> support_of_;
  Array<double> records_[2];  // NOLINT: pairs of memory
  Array<std::int32_t> held_row_, held_motions_, first_load_, load_;
  Array<std::uint8_t> held_bits_;
  Array<std::uint64_t> speed2_, spin2_;
  // What has been brought of them and of halts.
  bool has_looked_ = true;
  std::vector<Made> made_;
  std::vector<std::array<std::uint64_t, 2>> found_;  ///< squares of speed and spin, as bits
  // Beams that break.
  static constexpr std::size_t of_viscous = 6;
  std::vector<std::size_t> first_slot_of_run_, slot_of_;  ///< per run, and one more; per beam
  Array<BreakingOfRun> breaking_;
  Array<double> times_, limits_, breakable_, cracks_;
  Array<float> viscous_;
  Array<std::uint64_t> grown_;
  Array<RunOfTiles> runs_;
  Array<std::int32_t> last_;
  Array<std::uint32_t> why_;
  bool has_water_ = false;
  Array<WaterOfRun> waters_;
  Array<double> water_motions_, prisms_, wholes_, extents_, most2_, area_per_volume_, vertices_,
      expansions_, water_forces_, drag_works_, buoyancy_works_;
  Array<std::int32_t> first_vertex_, first_face_, first_corner_, corners_;
  ContactStore contacts_;
  std::vector<double> room_;
};

template <bool damped, bool breakable>
std::unique_ptr<Engine> make_engine_of(std::vector<Lattice> lattices, std::int32_t tile) {
  bool flat = true, eccentric = false;
  for (const Lattice& lattice : lattices)
    flat = flat && lattice.flat, eccentric = eccentric || lattice.eccentric;
  const auto make = [&]<template <class> class Frame>() {
    return std::make_unique<TileEngine<damped, breakable, Frame>>(std::move(lattices), tile);
  };
  if (eccentric) return make.template operator()<EccentricFrame>();
  if (flat) return make.template operator()<FlatFrame>();
  return make.template operator()<AnyFrame>();
}
std::unique_ptr<Engine> make_engine(std::vector<Lattice> lattices, std::int32_t tile) {
  const auto any = [&](auto has) { return std::any_of(lattices.begin(), lattices.end(), has); };
  const bool damped = any([](const Lattice&lattice) { return lattice.damped; }),
             breaks = any([](const Lattice&lattice) { return lattice.breaking.has_value(); });
  const auto make = damped   ? breaks ? make_engine_of<true, true> : make_engine_of<true, false>
                      : breaks ? make_engine_of<false, true>
                             : make_engine_of<false, false>;
  return make(std::move(lattices), tile);
}

}  // namespace
}  // namespace floe::device
