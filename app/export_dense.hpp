#pragma once

#include <string>

#include "core/export/dense_map.hpp"

namespace stillpoint {

/// What is made of a finished run's depth images.
struct DenseExport {
  std::string run, sequence;  ///< the run's folder, and where its sequence lies now; empty = where it lay
  std::string map;            ///< PLY file; empty = none
  std::string images;         ///< folder of the frames without what moved; empty = none
  int every = 5;              ///< frames that are fused, and that background is taken from
  bool force = false;
  DenseMapOptions options;
};

/// @throws InputError in one sentence for what cannot be opened or written, and for a sequence without depth
void export_dense(const DenseExport& wanted);

}  // namespace stillpoint
