/// \file
/// Identifiers that close themselves, for hdf5.cpp and hdf5_read.cpp.
#pragma once

#include <hdf5.h>

namespace floe {

/// Whether HDF5 has failed to write. HDF5 may crash when it closes the remains of such a write, so
/// from then on no identifier is closed; the run ends anyway.
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

/// Silences HDF5's own messages and keeps HDF5 from closing files at the end of the process, where
/// it would crash on files that it could not write. Call before any other function of HDF5.
inline void quiet_hdf5() {
  static const bool once = H5dont_atexit() >= 0;
  (void)once;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace floe
