#include <fmt/format.h>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/binary_rows.h"
#include "sim_cuda/import/npy.h"
#include "sim_cuda/import/table_file.h"

namespace collidoscope {

BodyTable read_npy_bodies(const std::string& file, const TableOptions& options) {
  const NpyArray array = read_npy(file);
  if (array.shape.size() != 2)
    throw InputError(
        fmt::format("{}: an array of shape {}, expected (n, 3) or (n, 4): x, y, z, radius of "
                    "each body",
                    file, shape_text(array.shape)));
  const std::size_t rows = array.shape[0], columns = array.shape[1];
  constexpr std::size_t most_columns = 4096;
  if (columns > most_columns)
    throw InputError(fmt::format("{}: {} columns, expected at most {}", file, columns, most_columns));
  const ColumnChoice choice = choose_columns(options.columns, {}, columns, file);
  BodyTableBuilder table(choice, rows, options.scale, file);
  const std::size_t row_step = array.fortran_order ? 1 : columns,
                    column_step = array.fortran_order ? rows : 1;
  array.visit([&](const auto* numbers) {
    store_rows(rows, table.targets(columns), file, [&](std::size_t row, std::size_t column) {
      return static_cast<double>(numbers[row * row_step + column * column_step]);
    });
  });
  return table.finish({}, columns);
}

}  // namespace collidoscope
