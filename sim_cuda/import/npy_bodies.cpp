#include <fmt/format.h>

#include <atomic>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/binary_rows.h"
#include "sim_cuda/import/npy.h"
#include "sim_cuda/import/table_file.h"

namespace collidoscope {
namespace {

/// Reads rows of a file in blocks that fit in a cache: the array as a whole is never in memory.
class NpyRows {
 public:
  NpyRows(const InputFile& file, const NpyLayout& layout) : file_(file), layout_(layout) {}

  void store(const std::vector<ColumnTarget>& targets) {
    const std::size_t rows = layout_.shape[0], columns = layout_.shape[1];
    const std::size_t row_bytes = columns * layout_.element_bytes;
    NpyArray::visit_numbers(layout_.element, nullptr, [&]<class Number>(const Number*) {
      store_blocks(rows, std::max<std::size_t>(block_bytes / row_bytes, 1), targets, file_.name(),
                   [&](std::size_t first, std::size_t count) {
                     std::vector<Number> block(count * columns);
                     if (file_.read(layout_.begin + first * row_bytes, block.data(), count * row_bytes) !=
                         count * row_bytes)
                       is_incomplete_ = true;
                     return [block = std::move(block), first, columns](std::size_t row, std::size_t column) {
                       return static_cast<double>(block[(row - first) * columns + column]);
                     };
                   });
    });
    if (is_incomplete_) throw InputError(fmt::format("{}: cannot be read to its end", file_.name()));
  }

 private:
  static constexpr std::size_t block_bytes = std::size_t{256} << 10;
  const InputFile& file_;
  const NpyLayout& layout_;
  std::atomic<bool> is_incomplete_ = false;
};

}  // namespace

BodyTable read_npy_bodies(const std::string& name, const TableOptions& options) {
  const InputFile file(name, "a NumPy file (.npy)");
  const NpyLayout layout = read_npy_layout(file);
  if (layout.shape.size() != 2)
    throw InputError(
        fmt::format("{}: an array of shape {}, expected (n, 3) or (n, 4): x, y, z, radius of each body", name,
                    shape_text(layout.shape)));
  const std::size_t rows = layout.shape[0], columns = layout.shape[1];
  constexpr std::size_t most_columns = 4096;
  if (columns < 1 || columns > most_columns)
    throw InputError(fmt::format("{}: {} columns, expected 1 to {}", name, columns, most_columns));
  if (options.preview == nullptr && !layout.fortran_order && !layout.swapped) {
    BodyTableBuilder table(choose_columns(options.columns, {}, columns, name), rows, options.scale, name);
    NpyRows(file, layout).store(table.targets(columns));
    return table.finish({}, columns);
  }
  const NpyArray array = read_npy(name);
  const std::size_t row_step = array.fortran_order ? 1 : columns,
                    column_step = array.fortran_order ? rows : 1;
  return array.visit([&](const auto* numbers) {
    const auto number_at = [&](std::size_t row, std::size_t column) {
      return static_cast<double>(numbers[row * row_step + column * column_step]);
    };
    if (options.preview != nullptr) {
      preview_numbers(*options.preview, {}, columns, rows, number_at);
      return BodyTable{};
    }
    BodyTableBuilder table(choose_columns(options.columns, {}, columns, name), rows, options.scale, name);
    store_rows(rows, table.targets(columns), name, number_at);
    return table.finish({}, columns);
  });
}

}  // namespace collidoscope
