/// \file
/// What both halves of hdf5.cpp need: identifiers that close themselves.
#pragma once

#include <hdf5.h>

namespace floe {

/// Whether HDF5 could not write something. It may crash where what is left of that is closed: from
/// then on nothing is closed any more, as the run is at its end.
inline bool hdf5_has_failed = false;  // NOLINT: state of the library

/// Closes an HDF5 identifier of any kind at the end of a scope.
class Hdf5Id {
 public:
  Hdf5Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Id() {
    if (id_ >= 0 && !hdf5_has_failed) close_(id_);
  }
  Hdf5Id(const Hdf5Id&) = delete;
  Hdf5Id& operator=(const Hdf5Id&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: HDF5 calls take the bare identifier

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Before the first call of HDF5: it prints nothing, and leaves files that it could not write alone
/// when the process ends.
inline void quiet_hdf5() {
  static const bool once = H5dont_atexit() >= 0;
  (void)once;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace floe
