#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/inspect/drawn_truth.hpp"
#include "core/inspect/sidecar.hpp"
#include "core/sequence/fingerprint.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct OutlineArguments {
  std::string sequence, outlines, out;
  SequenceArguments source;
};

void outline(const OutlineArguments& arguments) {
  const auto source = arguments.source.open(arguments.sequence, Config());
  const bool is_folder = fs::is_directory(arguments.sequence);
  if (!is_folder && arguments.outlines.empty())
    throw InputError(fmt::format("{}: is no folder with outlines in it; --outlines names a file of them",
                                 arguments.sequence));
  if (!is_folder && arguments.out.empty())
    throw InputError(
        fmt::format("{}: is no folder that masks can be written to; --out names one", arguments.sequence));
  const fs::path file =
      arguments.outlines.empty() ? fs::path(arguments.sequence) / kSidecarName : fs::path(arguments.outlines);
  if (!fs::exists(file))
    throw InputError(
        fmt::format("{}: there is no such file; outlines are drawn in the window's panel "
                    "\"Truth by hand\" and kept there",
                    file.string()));
  const Marks marks = read_marks(file, {source->name(), sequence_fingerprint(*source), source->size()});
  ExportControl control;
  const fs::path out = arguments.out.empty() ? arguments.sequence : arguments.out;
  std::optional<CarriedTruth> carried;
  {
    Progress progress(source->name(), source->size());
    control.progress = [&](const char*, int, int) {
      progress.advance("");
      throw_if_interrupted("stopped; the masks are as they were");
    };
    carried = write_drawn_truth(*source, marks.drawn, out, control);
  }
  fmt::print("{}.\nwritten to {}\n", carried->told(), out.string());
}

}  // namespace

void add_outline_command(CLI::App& app) {
  const auto arguments = std::make_shared<OutlineArguments>();
  CLI::App* command = app.add_subcommand(
      "outline", "Carry outlines drawn by hand round what moves to all frames, as the sequence's true masks");
  command->add_option("SEQUENCE", arguments->sequence, kSequenceHelp)->required();
  command->add_option("--outlines", arguments->outlines,
                      "A file of marks with outlines; otherwise the sequence's own stillpoint.json");
  command->add_option("--out", arguments->out, "Folder for mask.txt and mask/; otherwise the sequence's own");
  arguments->source.add_to(*command);
  command->callback([arguments] { outline(*arguments); });
}

}  // namespace stillpoint
