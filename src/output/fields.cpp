#include "output/fields.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "floe/base/petsc.h"

namespace floe {
namespace {

constexpr const char* key = "checkpoint: restart";
std::string number(std::size_t k) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu", k);
  return name;
}
std::string group_of(std::size_t frame) { return "/t" + number(frame); }
std::string segment_file(std::size_t first) { return "fields/" + number(first) + ".h5"; }
std::string mesh_of(std::size_t first) {
  return first == 0 ? "fields/mesh.h5" : "fields/mesh_" + number(first) + ".h5";
}
std::string segment_xmf(std::size_t first) { return "fields/" + number(first) + ".xmf"; }

/// Returns the number of a name NNNNNN.ENDING, nothing for other names.
std::optional<std::size_t> number_in(const std::string& name, std::string_view ending) {
  constexpr std::size_t least = 6, most = 18;
  const std::size_t digits = name.find_first_not_of("0123456789");
  if (digits == std::string::npos || digits < least || digits > most ||
      std::string_view(name).substr(digits) != ending)
    return {};
  return std::stoull(name.substr(0, digits));
}

/// Returns the number of a name mesh_NNNNNN.h5.
std::optional<std::size_t> number_of_mesh(const std::string& name) {
  constexpr std::string_view front = "mesh_";
  if (!name.starts_with(front)) return {};
  return number_in(name.substr(front.size()), ".h5");
}

/// Returns the names of the files in a folder, none if there is no folder.
std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    names.push_back(entry->path().filename().string());
  return names;
}

/// Returns the first frames of the segments in a folder, in order.
std::vector<std::size_t> segments_in(const std::string& folder) {
  std::vector<std::size_t> segments;
  for (const std::string& name : names_in(folder)) {
    if (const auto first = number_in(name, ".h5")) segments.push_back(*first);
  }
  std::sort(segments.begin(), segments.end());
  return segments;
}

void remove(const std::string& path) {
  std::error_code error;
  std::filesystem::remove(path, error);
  if (error) throw_file_error("remove", path, error.value());
}

}  // namespace

Fields::Fields(std::string dir, const Lattice& lattice, std::int64_t keep, std::int64_t mesh,
               std::span<const std::int32_t> names)
    : dir_(std::move(dir)), writer_(lattice) {
  for (const char* name : {"fields.xmf", "fields.h5"}) remove_left_over(path(name));
  if (keep < 0) {
    begin();
    return;
  }
  count_ = static_cast<std::size_t>(keep);
  Earlier earlier = look_at(dir_, count_);
  segments_ = std::move(earlier.segments);
  last_ = std::move(earlier.last);
  const auto present = static_cast<std::size_t>(mesh);
  for (const std::string& name : names_in(path("fields"))) {
    const auto first = number_of_mesh(name);
    if (first && *first < present) meshes_.push_back(*first);
  }
  std::sort(meshes_.begin(), meshes_.end());
  if (present > 0) {
    meshes_.push_back(present);
    write_mesh(names);  // a later mesh may have taken its name
    if (segments_.back() < present) last_.clear();
  }
  cut_back();
}

void Fields::write_mesh(std::span<const std::int32_t> names) {
  Hdf5File mesh = Hdf5File::create(path(mesh_file()));
  writer_->write_mesh(mesh);
  if (!names.empty()) mesh.write("/mesh/name", names);
  mesh.close();
  not_on_disk_.push_back(path(mesh_file()));
}

std::string Fields::mesh_file() const { return mesh_of(meshes_.back()); }

void Fields::follow(const Lattice& lattice, std::span<const std::int32_t> names) {
  if (is_open()) {
    const std::string full = path(segment_xmf(segments_.back()));
    write_whole(full, xdmf_document(grids_of_last()));
    not_on_disk_.push_back(full);
    not_on_disk_.push_back(path(segment_file(segments_.back())));
    last_.clear();
  }
  if (count_ > meshes_.back()) meshes_.push_back(count_);
  writer_.emplace(lattice);
  write_mesh(names);
}

void Fields::require(const std::string& dir, std::int64_t frames) {
  (void)look_at(dir, static_cast<std::size_t>(frames));
}

Fields::Earlier Fields::look_at(const std::string& dir, std::size_t keep) {
  const std::string folder = dir + "/fields";
  const std::vector<std::size_t> found = segments_in(folder);
  Earlier earlier;
  std::size_t count = 0;
  for (std::size_t s = 0; s < found.size() && found[s] < keep && found[s] == count; ++s) {
    const Hdf5File file = Hdf5File::open(dir + "/" + segment_file(count), key);
    earlier.segments.push_back(count);
    earlier.last.clear();
    const std::size_t end = s + 1 < found.size() ? std::min(found[s + 1], keep) : keep;
    for (; count < end && file.has(group_of(count)); ++count) {
      const std::string group = group_of(count), cracks = group + "/cracks";
      earlier.last.push_back(
          {file.read_attribute(group, "time"),
           file.has(cracks) ? static_cast<std::size_t>(file.shape(cracks).first) : 0,
           file.has(group + "/damage")});
    }
  }
  if (count < keep)
    throw InputError(std::string(key) + ": '" + folder + "' has " + std::to_string(count) +
                     " frames, the checkpoint knows of " + std::to_string(keep) +
                     ": a run goes on in the folder where it began");
  return earlier;
}

void Fields::begin() {
  remove_earlier();
  std::error_code error;
  std::filesystem::create_directory(path("fields"), error);
  if (error) throw_file_error("make", path("fields"), error.value());
  write_mesh({});
  write_index();
}

/// Removes the files of an earlier run, those first that name the others. A process that reads an
/// open file keeps it.
void Fields::remove_earlier() const {
  for (const char* name : {"fields.xmf", "fields.h5"}) remove(path(name));
  for (const std::string& name : names_in(path("fields"))) {
    const bool ours = number_in(name, ".h5") || number_in(name, ".xmf") || name == "mesh.h5" ||
                      number_of_mesh(name) || name.ends_with(temporary_ending);
    if (ours) remove(path("fields/" + name));
  }
}

/// Removes frames after those to keep, names first, so that a process killed in between leaves no
/// name of a missing frame.
void Fields::cut_back() {
  write_xmf();  // a run killed before it named its last frame has no name of it yet
  write_index();
  if (!segments_.empty()) {
    const std::string file = path(segment_file(segments_.back()));
    if (Hdf5File::open(file, key).has(group_of(count_))) {
      Hdf5File kept = Hdf5File::change(file);
      for (std::size_t k = count_; kept.has(group_of(k)); ++k) kept.remove(group_of(k));
      kept.close();
    }
  }
  const std::size_t last = segments_.empty() ? 0 : segments_.back();
  for (const std::string& name : names_in(path("fields"))) {
    const auto segment = number_in(name, ".h5"), xmf = number_in(name, ".xmf"),
               mesh = number_of_mesh(name);
    const bool later = (segment && (*segment > last || segments_.empty())) ||
                       (xmf && (*xmf > last || (*xmf == last && is_open()) || segments_.empty())) ||
                       (mesh && *mesh > meshes_.back());
    if (later || name.ends_with(temporary_ending)) remove(path("fields/" + name));
  }
}

/// Size of a frame's values [bytes]; HDF5 needs somewhat more.
std::size_t Fields::bytes(const Kept& frame) const {
  const GridSizes& s = writer_->sizes();
  return 24 * (s.points + 3 * s.bodies + s.faces) + 80 * s.beams +
         (frame.breakable ? 8 * s.beams : 0) + 116 * frame.cracks;
}

bool Fields::last_is_full() const {
  std::size_t sum = 0;
  for (const Kept& frame : last_) sum += bytes(frame);
  return segments_.empty() || !is_open() || last_.size() >= segment_frames || sum >= segment_bytes;
}

void Fields::write(const Frame& frame) {
  const bool is_new = last_is_full();
  const std::size_t first = is_new ? count_ : segments_.back();
  const std::string file = path(segment_file(first));
  Hdf5File segment = is_new ? Hdf5File::create(file) : Hdf5File::change(file);
  const std::size_t cracks = writer_->write(segment, group_of(count_), frame);
  if (meshes_.back() > 0)
    segment.attribute(group_of(count_), "mesh", static_cast<double>(meshes_.back()));
  if (is_new && is_open()) {
    const std::string full = path(segment_xmf(segments_.back()));
    write_whole(full, xdmf_document(grids_of_last()));
    not_on_disk_.push_back(full);
    not_on_disk_.push_back(
        path(segment_file(segments_.back())));  // the last frames of the full segment
  }
  segment.close(Place::swapped);
  if (is_new) {
    segments_.push_back(first);
    not_on_disk_.push_back(file);
    last_.clear();
  }
  last_.push_back({frame.time, cracks, !frame.damage.empty()});
  ++count_;
  write_xmf();  // after the frame is on file, so that every named frame exists
  // Links are rewritten after every sixteenth of the frames: so seldom that it costs no time.
  constexpr std::size_t part = 16;
  if (count_ - linked_ > linked_ / part) write_index();
}

/// XDMF grids of the last segment's frames.
std::string Fields::grids_of_last() const {
  std::string grids;
  for (std::size_t k = 0; k < last_.size(); ++k)
    grids += xdmf_grid(writer_->sizes(), mesh_file(),
                       {segment_file(segments_.back()), group_of(segments_.back() + k),
                        last_[k].time, last_[k].cracks, last_[k].breakable});
  return grids;
}

void Fields::write_xmf() const {
  std::string grids;
  for (std::size_t k = 0; k + (is_open() ? 1 : 0) < segments_.size(); ++k)
    grids += xdmf_include(segment_xmf(segments_[k]));
  write_whole(path("fields.xmf"), xdmf_document(grids + grids_of_last()), Place::swapped);
}

void Fields::write_index() {
  Hdf5File index = Hdf5File::create(path("fields.h5"));
  index.link("/mesh", mesh_of(0), "/mesh");
  for (std::size_t k = 1; k < meshes_.size(); ++k)
    index.link("/mesh_" + number(meshes_[k]), mesh_of(meshes_[k]), "/mesh");
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const std::size_t end = s + 1 < segments_.size() ? segments_[s + 1] : count_;
    for (std::size_t k = segments_[s]; k < end; ++k)
      index.link(group_of(k), segment_file(segments_[s]), group_of(k));
  }
  index.close(Place::swapped);
  linked_ = count_;
}

void Fields::finish() {
  if (linked_ < count_) write_index();
}

void Fields::sync() {
  if (not_on_disk_.empty() && segments_.empty()) return;
  if (!segments_.empty()) not_on_disk_.push_back(path(segment_file(segments_.back())));
  for (const std::string& file : not_on_disk_) sync_to_disk(file);
  sync_to_disk(path("fields"));
  sync_to_disk(path("fields.xmf"));
  not_on_disk_.clear();
}

}  // namespace floe
