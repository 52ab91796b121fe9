#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "core/evaluation/page_tables.hpp"
#include "core/motion/methods.hpp"
#include "core/out_folder.hpp"
#include "core/run/ablation.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

struct TablesArguments {
  std::vector<std::string> pages;
  bool check = false;
};

void make_tables(const TablesArguments& arguments) {
  bool differs = false;
  for (const std::string& path : arguments.pages) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const std::string page = read_text(path);
    const TableSources sources{
        [&folder](const std::string& file) { return read_results((folder / file).string()); },
        [&folder](const std::string& file) { return read_ablation((folder / file).string()).summary(); },
        [&folder](const std::string& file) {
          const std::string results = (folder / file).string();
          return provenance_from_json(read_text(results), results);
        }};
    const std::string made = with_tables(page, path, baseline_method().name, sources);
    if (page.find("<!-- table:") == std::string::npos) {
      fmt::print("{}: has no marked table\n", path);
    } else if (made == page) {
      fmt::print("{}: its tables are those of its results\n", path);
    } else if (arguments.check) {
      differs = true;
      fmt::print("{}: its tables are not those of its results\n", path);
    } else {
      write_text_file(path, made);
      fmt::print("{}: tables made anew\n", path);
    }
  }
  if (differs) throw ExitStatus{1};
}

}  // namespace

void add_tables_command(CLI::App& app) {
  const auto arguments = std::make_shared<TablesArguments>();
  CLI::App* command = app.add_subcommand(
      "tables",
      "Make the marked tables of Markdown pages anew, from the results of benchmarks and ablations");
  command
      ->add_option("PAGES", arguments->pages,
                   "Pages with tables between '<!-- table: FILE WHAT … -->' and '<!-- end of table -->'")
      ->required();
  command->add_flag("--check", arguments->check, "Change nothing; the exit status is 1 where a page differs");
  command->callback([arguments] { make_tables(*arguments); });
}

}  // namespace stillpoint
