/// \file
/// Makes lists of pairs in the memory of an engine (list_step.h).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "device/engine.h"
#include "device/launch.h"
#include "device/list_step.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// What lists of the pairs of all runs need beside the contacts.
class PairLister {
 public:
  /// \param first_body, first_obstacle  per run, and one more
  void take(const std::vector<Lattice>& lattices, std::span<const std::int32_t> first_body,
            std::span<const std::int32_t> first_obstacle) {
    const auto bodies = static_cast<std::size_t>(first_body.back()),
               obstacles = static_cast<std::size_t>(first_obstacle.back());
    std::vector<double> sizes(bodies), widths(bodies + obstacles), frictions(2 * obstacles);
    std::vector<std::int32_t> rank(bodies), by_rank(bodies);
    for (std::size_t r = 0; r < lattices.size(); ++r) {
      const auto body = static_cast<std::size_t>(first_body[r]), of = bodies_of(first_body, r),
                 obstacle = static_cast<std::size_t>(first_obstacle[r]);
      ListedRun& run = runs_.emplace_back();
      run.run = static_cast<std::int32_t>(r);
      run.first_body = first_body[r], run.bodies = static_cast<std::int32_t>(of);
      run.first_obstacle = first_obstacle[r];
      run.obstacles = first_obstacle[r + 1] - first_obstacle[r];
      const auto& contacts = lattices[r].contacts;
      std::vector<std::vector<std::int32_t>> ends(of);
      radius_.emplace_back();
      if (contacts && contacts->listing) {
        const Listing& l = *contacts->listing;
        most_bodies_ = std::max(most_bodies_, of);
        std::copy_n(l.sizes.begin(), of, &sizes[body]);
        std::copy_n(l.widths.begin(), of, &widths[body]);
        std::copy(l.widths.begin() + static_cast<std::ptrdiff_t>(of), l.widths.end(),
                  widths.begin() + static_cast<std::ptrdiff_t>(bodies + obstacle));
        for (std::size_t k = 0; k < l.frictions.size(); ++k)
          std::copy_n(l.frictions[k].begin(), 2, &frictions[2 * (obstacle + k)]);
        for (std::size_t b = 0; b < of; ++b) {
          rank[body + b] = l.ranks[b];
          by_rank[body + static_cast<std::size_t>(l.ranks[b])] =
              first_body[r] + static_cast<std::int32_t>(b);
        }
        for (const auto& [i, j] : l.beams) {
          ends[static_cast<std::size_t>(i)].push_back(first_body[r] + j);
          ends[static_cast<std::size_t>(j)].push_back(first_body[r] + i);
        }
        set_run(l, *contacts, run);
        radius_.back().assign(contacts->radius.begin(),
                              contacts->radius.begin() + static_cast<std::ptrdiff_t>(of));
      }
      for (const auto& list : ends) {
        beams_.insert(beams_.end(), list.begin(), list.end());
        first_beam_.push_back(static_cast<std::int32_t>(beams_.size()));
      }
    }
    sizes_ = keep(sizes), widths_ = keep(widths), frictions_ = keep(frictions);
    rank_ = keep(rank), by_rank_ = keep(by_rank);
    first_beam_here_ = keep(first_beam_), beams_here_ = keep(beams_);
    broken_ = Array<std::uint8_t>(beams_.size());
    piece_ = Array<std::int32_t>(bodies), states_ = Array<std::uint8_t>(bodies);
    ready_.assign(lattices.size(), false);
    large_.resize(lattices.size());
  }

  /// Sets who may touch of a run.
  void put(std::size_t r, const Eligible& eligible) {
    ListedRun& run = runs_[r];
    ready_[r] = !eligible.pieces.empty() && run.reach > 0;
    if (!ready_[r]) return;
    const auto first = static_cast<std::size_t>(run.first_body);
    std::vector<std::uint8_t> states = eligible.states;
    mark_large(run, radius_[r], states, large_[r]);
    piece_.put(eligible.pieces, first);
    states_.put(states, first);
    const auto begin = static_cast<std::size_t>(first_beam_[first]);
    std::vector<std::uint8_t> broken(static_cast<std::size_t>(first_beam_[first + states.size()]) -
                                     begin);
    const auto mark = [&](std::int32_t body, std::int32_t other) {
      const auto b = first + static_cast<std::size_t>(body);
      for (std::int32_t k = first_beam_[b]; k < first_beam_[b + 1]; ++k)
        if (beams_[static_cast<std::size_t>(k)] == run.first_body + other)
          broken[static_cast<std::size_t>(k) - begin] = 1;
    };
    for (const auto& [i, j] : eligible.broken) mark(i, j), mark(j, i);
    broken_.put(broken, begin);
  }
  bool is_ready(std::size_t run) const { return ready_[run]; }

  /// Makes the pairs of a run, in memory of this object. Returns their number; -1: there are more
  /// than there is room for.
  /// \param room    for pairs \param memory  contacts and what changes of them; completed
  std::int32_t make(std::size_t r, std::size_t room, std::span<const double> obstacles,
                    ListMemory& memory, Queue& queue) {
    give_room(room);
    if (large_[r].size() > large_here_.size()) large_here_ = Array<std::int32_t>(large_[r].size());
    large_here_.put(large_[r]);
    if (obstacles.size() > frames_.size()) frames_ = Array<double>(obstacles.size());
    frames_.put(obstacles);
    complete(r, memory);
    const std::int32_t bodies = memory.of.bodies, buckets = memory.of.buckets;
    queue.once([&](const auto& launch) {
      const auto each = each_of(launch);
      each(SetZero{memory.in_bucket}, buckets);
      each(FindCells{memory}, bodies);
      sums(each, memory.in_bucket, memory.first_in_bucket, buckets, 0);
      each(SetZero{memory.in_bucket}, buckets);
      each(FillBuckets{memory}, bodies);
      each(CountPairs{memory}, bodies);
      sums(each, memory.count, memory.first, bodies, 0);
    });
    queue.wait();
    std::array<std::int32_t, 1> number{};
    of_blocks_.get(number, blocks(bodies));
    if (static_cast<std::size_t>(number[0]) > room) return -1;
    queue.once([&](const auto& launch) { each_of(launch)(WritePairs{memory}, bodies); });
    return number[0];
  }
  /// Takes the pairs that have been made over into the contacts.
  /// \param first_pair  of the run
  void take_over(const ListMemory& memory, std::int32_t pairs, std::int64_t first_pair,
                 Queue& queue) {
    const std::int32_t bodies = memory.of.bodies;
    std::int32_t* count = memory.end_count + memory.of.first_body;
    const auto first_end = 2 * static_cast<std::int32_t>(first_pair);
    queue.once([&](const auto& launch) {
      const auto each = each_of(launch);
      each(TakePairs{memory}, pairs);
      each(SetZero{count}, bodies);
      each(CountEnds{memory}, pairs);
      sums(each, count, memory.first_end + memory.of.first_body, bodies, first_end);
      each(SetZero{count}, bodies);
      each(WriteEnds{memory}, pairs);
      each(SortEnds{memory}, bodies);
      if (memory.of.obstacles > 0) launch(ListObstacles{{memory}, pairs}, 1, most_threads, 0);
    });
    queue.wait();
  }

 private:
  template <class T>
  static Array<T> keep(const std::vector<T>& values) {
    return Array<T>(std::span<const T>(values));
  }
  static std::size_t bodies_of(std::span<const std::int32_t> first_body, std::size_t run) {
    return static_cast<std::size_t>(first_body[run + 1] - first_body[run]);
  }
  static std::size_t blocks(std::int32_t number) {
    return static_cast<std::size_t>((number + of_block - 1) / of_block);
  }
  template <class Launch>
  static auto each_of(const Launch& launch) {
    return [&launch](const auto& work, std::int32_t number) {
      launch(Each<std::decay_t<decltype(work)>>{work, number},
             static_cast<std::int32_t>(blocks(number)), most_threads, std::size_t{0});
    };
  }
  template <class EachOf>
  void sums(const EachOf& each, const std::int32_t* count, std::int32_t* first, std::int32_t number,
            std::int32_t begin) {
    const auto of = static_cast<std::int32_t>(blocks(number));
    each(SumBlocks{count, of_blocks_.data(), number}, of);
    each(SumBefore{of_blocks_.data(), of}, 1);
    each(SumWithin{count, of_blocks_.data(), first, number, begin}, of);
  }

  static void set_run(const Listing& l, const Contacts& contacts, ListedRun& run) {
    run.reach = l.reach;
    run.young = l.young, run.young_broken = l.young_broken;
    run.friction = l.friction, run.friction_wet = l.friction_wet;
    run.periods.length = {contacts.periods[0], contacts.periods[1], contacts.periods[2]};
    const auto twice = static_cast<std::uint32_t>(2 * std::max(run.bodies, 64));
    run.buckets = static_cast<std::int32_t>(std::bit_ceil(twice));
  }
  /// Finds the bodies that are far larger than the mean, and the cells for the others.
  static void mark_large(ListedRun& run, std::span<const double> radius,
                         std::vector<std::uint8_t>& states, std::vector<std::int32_t>& large) {
    constexpr double far_larger = 4;
    double mean = 0;
    for (std::size_t b = 0; b < states.size(); ++b)
      if ((states[b] & Eligible::left_out) == 0)
        mean += radius[b] / static_cast<double>(states.size());
    large.clear();
    run.cell = run.reach;
    for (std::size_t b = 0; b < states.size(); ++b) {
      if ((states[b] & Eligible::left_out) != 0) continue;
      if (radius[b] > far_larger * mean) {
        states[b] |= Eligible::large;
        large.push_back(run.first_body + static_cast<std::int32_t>(b));
      } else {
        run.cell = std::max(run.cell, 2 * radius[b] + run.reach);
      }
    }
    run.large = static_cast<std::int32_t>(large.size());
    const auto columns = [&](double period) {
      return period > 0 ? std::max(1, static_cast<std::int32_t>(period / run.cell)) : 0;
    };
    run.columns_x = columns(run.periods.length.x), run.columns_y = columns(run.periods.length.y);
  }

  void give_room(std::size_t room) {
    const std::size_t buckets = std::bit_ceil(2 * std::max<std::size_t>(most_bodies_, 64));
    if (cells_.size() == 0) {
      cells_ = Array<std::int32_t>(3 * most_bodies_);
      bucket_ = Array<std::int32_t>(most_bodies_), entries_ = Array<std::int32_t>(most_bodies_);
      count_ = Array<std::int32_t>(most_bodies_), first_ = Array<std::int32_t>(most_bodies_);
      in_bucket_ = Array<std::int32_t>(buckets), first_in_bucket_ = Array<std::int32_t>(buckets);
      of_blocks_ = Array<std::int32_t>(blocks(static_cast<std::int32_t>(buckets)) + 1);
    }
    if (room <= a_.size()) return;
    a_ = Array<std::int32_t>(room), b_ = Array<std::int32_t>(room);
    face_ = Array<std::int32_t>(room), pair_states_ = Array<std::uint8_t>(room);
    const auto numbers = [room](std::size_t of) { return Array<double>(room * of); };
    constants_ = numbers(DevicePairs::constants), history_ = numbers(DevicePairs::history);
    crushes_ = numbers(DevicePairs::crush);
  }

  void complete(std::size_t r, ListMemory& m) {
    const auto room = static_cast<std::int64_t>(a_.size());
    m.solids = {sizes_.data(),      widths_.data(), frictions_.data(), rank_.data(),
                by_rank_.data(),    piece_.data(),  states_.data(),    first_beam_here_.data(),
                beams_here_.data(), broken_.data()};
    m.of = runs_[r];
    m.obstacles = frames_.data();
    m.large = large_here_.data();
    m.cells = cells_.data();
    m.bucket = bucket_.data(), m.in_bucket = in_bucket_.data();
    m.first_in_bucket = first_in_bucket_.data(), m.entries = entries_.data();
    m.count = count_.data(), m.first = first_.data();
    m.a = a_.data(), m.b = b_.data(), m.face = face_.data(), m.states = pair_states_.data();
    m.constants = {constants_.data(), room};
    m.history = {history_.data(), room};
    m.crushes = {crushes_.data(), room};
  }

  std::vector<ListedRun> runs_;
  std::vector<bool> ready_;
  std::vector<std::int32_t> first_beam_{0}, beams_;
  std::vector<std::vector<std::int32_t>> large_;  ///< per run
  std::size_t most_bodies_ = 0;                   ///< of a run
  std::vector<std::vector<double>> radius_;       ///< per run and body [m]
  Array<double> sizes_, widths_, frictions_, frames_, constants_, history_, crushes_;
  Array<std::int32_t> rank_, by_rank_, first_beam_here_, beams_here_, piece_, large_here_, cells_,
      bucket_, entries_, count_, first_, in_bucket_, first_in_bucket_, of_blocks_, a_, b_, face_;
  Array<std::uint8_t> states_, broken_, pair_states_;
};

}  // namespace
}  // namespace floe::device
