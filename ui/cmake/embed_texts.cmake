# Writes OUTPUT, a C++ source in which FUNCTION, declared in HEADER, gives the text of each file in FILES (a list, `,` between
# names) by its name.
string(REPLACE "," ";" files "${FILES}")
set(entries "")
foreach(file IN LISTS files)
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" text)
  string(APPEND entries "      {\"${name}\", R\"embedded(${text})embedded\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "// Generated: the text of files.
#include \"${HEADER}\"

#include <map>

namespace stillpoint {

std::string_view ${FUNCTION}(std::string_view file_name) {
  static const std::map<std::string_view, std::string_view> kTexts = {
${entries}  };
  return kTexts.at(file_name);
}

}  // namespace stillpoint
")
