#pragma once
// Readers of tables of bodies, by format. Each throws InputError with one line per fault.

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/import/body_table.h"
#include "sim_cuda/import/file_format.h"

namespace collidoscope {

/// The start of a table, for the choice of its columns.
struct TablePreview {
  std::vector<std::string> names;  ///< of columns; empty: they have none
  std::size_t columns = 0;
  std::vector<std::vector<std::string>> rows;  ///< fields of the first rows
  static constexpr std::size_t most_rows = 5;
};

struct TableOptions {
  ColumnMap columns;
  double scale = 1;        ///< m per unit of length in the file
  std::int64_t frame = 0;  ///< of a file with several
  /// Set: it is filled, and the reader returns an empty table.
  TablePreview* preview = nullptr;
};

/// Reads the bodies of a file of any of these formats: npy, npz, csv, xyz, lammps, ply.
BodyTable read_body_table(const std::string& file, FileFormat format, const TableOptions& options);

/// The columns and the first rows of a frame. Throws InputError.
TablePreview preview_body_table(const std::string& file, FileFormat format, std::int64_t frame);

/// The same for all frames from options.frame on; one in formats without frames. All have the same number of
/// bodies.
std::vector<BodyTable> read_body_frames(const std::string& file, FileFormat format,
                                        const TableOptions& options);
/// One frame of each file.
std::vector<BodyTable> read_body_series(const std::vector<std::string>& files, const TableOptions& options);
/// Orders names so that numbers in them count as numbers: a2 before a10.
void sort_by_numbers(std::vector<std::string>& files);

/// An array with a row for each body: columns as in choose_columns(), without names.
BodyTable read_npy_bodies(const std::string& file, const TableOptions& options);
/// Arrays by name: position (n, 3), radius (n), velocity (n, 3), angular_velocity (n, 3), mass, id; or x, y,
/// z and so on, each (n).
BodyTable read_npz_bodies(const std::string& file, const TableOptions& options);
/// Text with commas, semicolons, tabs or spaces. Names of columns are in the first line, or in the comment
/// before it.
BodyTable read_csv_bodies(const std::string& file, const TableOptions& options);
/// Number of atoms, comment, rows `element x y z ...`. The comment of extended XYZ names the columns. Reads
/// at most `most` frames from options.frame on.
std::vector<BodyTable> read_xyz_frames(const std::string& file, const TableOptions& options,
                                       std::int64_t most);
/// Text dump of LAMMPS or LIGGGHTS.
std::vector<BodyTable> read_lammps_frames(const std::string& file, const TableOptions& options,
                                          std::int64_t most);
/// The vertices of a PLY file without faces.
BodyTable read_ply_bodies(const std::string& file, const TableOptions& options);

/// For readers: the preview of rows of text, and of numbers.
std::string preview_number(double number);
void preview_text(TablePreview& preview, std::span<const std::string> names, std::size_t columns,
                  std::string_view rows, char separator, bool comments);
template <class NumberAt>
void preview_numbers(TablePreview& preview, std::span<const std::string> names, std::size_t columns,
                     std::size_t rows, const NumberAt& number) {
  preview.names.assign(names.begin(), names.end());
  preview.columns = columns;
  for (std::size_t row = 0; row < std::min(rows, TablePreview::most_rows); ++row) {
    std::vector<std::string>& fields = preview.rows.emplace_back();
    for (std::size_t column = 0; column < columns; ++column)
      fields.push_back(preview_number(number(row, column)));
  }
}

}  // namespace collidoscope
