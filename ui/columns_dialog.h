#pragma once
// Choice of the columns of a file of bodies. Plain data between the window and the panel.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

struct ColumnsDialog {
  bool open = false;
  std::string file, format;
  std::vector<std::string> names;              ///< of columns, or their numbers
  bool has_names = false;                      ///< the file has names
  std::vector<std::vector<std::string>> rows;  ///< fields of the first rows
  std::vector<std::string> quantities;         ///< that a column can have
  std::vector<int> meaning;                    ///< of each column: index into `quantities`, or -1
  double radius = 0;                           ///< m, if no column has it; 0: assumed
  double scale = 1;                            ///< m per unit of length in the file
  std::int64_t frame = 0;                      ///< of a file with several
  std::string fault;       ///< why the file cannot be opened with this choice; set by the window
  bool confirmed = false;  ///< request: open the file
};

}  // namespace collidoscope
