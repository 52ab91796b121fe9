#pragma once

#include <string>

namespace stillpoint {

/// A finished run's map as NAME.ply, in colour and with normals where depth images tell them, and its
/// keyframes as pyramids beside it, NAME_keyframes.ply.
struct MapExport {
  std::string run, sequence;  ///< the run's folder, and where its sequence lies now; empty = where it lay
  std::string to;             ///< NAME.ply
  int every = 5;              ///< keyframes, and every so many frames, are looked at for normals
  bool force = false;
};

/// @throws InputError in one sentence for what cannot be opened or written, and for a run without a map
void export_map(const MapExport& wanted);

}  // namespace stillpoint
