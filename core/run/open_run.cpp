#include "core/run/open_run.hpp"

#include <fmt/format.h>

#include <future>

#include "core/error.hpp"
#include "core/run/recorded_source.hpp"
#include "core/sequence/fingerprint.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code failed;
  return fs::exists(path, failed);
}

/// Where the sequence is to be looked for.
std::string place_of(const SequenceOrigin& origin, const fs::path& folder) {
  if (origin.is_generated() || is_there(origin.where) || origin.where_from_run.empty()) return origin.where;
  const fs::path beside = folder / origin.where_from_run;
  return is_there(beside) ? beside.lexically_normal().string() : origin.where;
}

/// The sequence, when it is the one the run was made of.
/// @throws InputError when it is not
std::unique_ptr<FrameSource> open_as_it_was(const SequenceOrigin& origin, const std::string& where,
                                            const fs::path& folder) {
  OpenOptions options;
  options.camera = origin.camera;
  options.frames = origin.frames_asked;
  options.seed = origin.seed;
  options.frame_rate = origin.frame_rate;
  options.depth_offset_s = origin.depth_offset_s;
  options.truth = origin.truth;
  options.inverted_masks = origin.inverted_masks;
  options.depth_scale = origin.depth_scale;
  options.topics = origin.topics;
  options.stereo = origin.stereo;
  auto source = open_sequence(where, options);
  if (sequence_fingerprint(*source) != origin.fingerprint)
    throw InputError(fmt::format("{}: is not, or no longer, the sequence that the run in {} was made of",
                                 where, folder.string()));
  return source;
}

}  // namespace

bool is_run_folder(const fs::path& folder) {
  for (const char* list : {"rgb.txt", "associations.txt"})
    if (is_there(folder / list)) return false;
  return is_there(folder / kRecordsName) || is_there(folder / "summary.json");
}

void throw_if_no_records(const fs::path& folder) {
  if (is_there(folder / kRecordsName)) return;
  if (!is_there(folder)) throw InputError(fmt::format("{}: there is no such folder", folder.string()));
  if (is_there(folder / "summary.json"))
    throw InputError(fmt::format(
        "{}: has no {}, without which a run cannot be looked at; `stillpoint run … --force` writes it anew",
        folder.string(), kRecordsName));
  throw InputError(
      fmt::format("{}: is no finished run's folder, as it has no {}; `stillpoint run SEQUENCE --out FOLDER` "
                  "leaves one",
                  folder.string(), kRecordsName));
}

OpenedRun open_run(const fs::path& folder, const std::string& sequence) {
  throw_if_no_records(folder);
  OpenedRun opened;
  // The sequence is opened while the records are read.
  std::future<std::unique_ptr<FrameSource>> opening;
  const auto recorded = std::make_shared<RecordedRun>(read_records(folder, [&](const SequenceOrigin& origin) {
    opening = std::async(std::launch::async, [&folder, &sequence, origin] {
      return open_as_it_was(origin, sequence.empty() ? place_of(origin, folder) : sequence, folder);
    });
  }));
  opened.recorded = recorded;
  try {
    opened.source = opening.get();
    // A run that was killed left no ground truth: the sequence still has it.
    if (!recorded->cut_short.empty()) recorded->ground_truth = opened.source->ground_truth();
  } catch (const InputError& error) {
    if (!sequence.empty()) throw;
    opened.no_images = error.what();
    opened.source = make_recorded_source(opened.recorded, opened.no_images);
  }
  return opened;
}

}  // namespace stillpoint
