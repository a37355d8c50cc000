#include "viewer/render/renderer.h"

#include <algorithm>
#include <chrono>

#include "viewer/render/colors.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

gl::TextureHandle color_map_texture(const std::array<Rgb, 256>& map) {
  gl::TextureHandle texture = gl::make_texture("colour map", 256, 1, GL_RGBA8);
  std::vector<std::uint8_t> texels;
  const auto to_byte = [](float value) { return static_cast<std::uint8_t>(value * 255 + 0.5f); };
  for (const Rgb& color : map)
    texels.insert(texels.end(), {to_byte(color.r), to_byte(color.g), to_byte(color.b), 255});
  glTextureSubImage2D(texture.get(), 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  glTextureParameteri(texture.get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture.get(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl::check("create the colour map");
  return texture;
}

// OpenGL returns rows from the bottom.
template <class Texel>
void flip_rows(std::vector<Texel>& texels, std::size_t row, int height) {
  for (int y = 0; y < height / 2; ++y)
    std::swap_ranges(texels.begin() + static_cast<std::ptrdiff_t>(row) * y,
                     texels.begin() + static_cast<std::ptrdiff_t>(row) * (y + 1),
                     texels.begin() + static_cast<std::ptrdiff_t>(row) * (height - 1 - y));
}

BoxColors box_colors(const FrameLayers& layers, const ValueRange& values) {
  if (layers.box_color == NodeMetric::level) return {};
  // -1: no value of this metric.
  return {layers.box_color,
          values.box_min,
          values.box_max,
          static_cast<double>(layers.box_low),
          static_cast<double>(layers.box_high),
          values.boxes};
}

}  // namespace

Renderer::Renderer(int width, int height, DrawOptions options)
    : options_(options),
      software_(gl::is_software_renderer()),
      colors_(color_map_texture(color_map())),
      heat_(color_map_texture(heat_map())) {
  prepare_light();
  resize(width, height);
  const float black[4] = {0, 0, 0, 1};
  glClearNamedFramebufferfv(picture_->framebuffer(), GL_COLOR, 0, black);
}

void Renderer::resize(int width, int height) {
  if (surface_ && picture_ && picture_->width() == width && picture_->height() == height) return;
  const int w = width * options_.supersampling, h = height * options_.supersampling;
  surface_.emplace("surface", w, h, std::vector<GLenum>{GL_RGBA8, GL_RGB10_A2}, GL_DEPTH_COMPONENT32F);
  // Lighting and lines test the depth of the surfaces and never write it.
  lit_.emplace("lit image", w, h, std::vector<GLenum>{GL_RGBA8}, 0);
  glNamedFramebufferTexture(lit_->framebuffer(), GL_DEPTH_ATTACHMENT, surface_->depth(), 0);
  if (picture_ && !previous_) previous_ = std::move(picture_);
  picture_.emplace("picture", width, height, std::vector<GLenum>{GL_RGBA8}, 0);
  ids_.reset();
  light_->resize(width, height);
}

void Renderer::set_options(const DrawOptions& options) {
  if (options == options_) return;
  const int w = width(), h = height();
  const bool relight = options.light != options_.light || options.light_method != options_.light_method;
  options_ = options;
  if (relight) prepare_light();
  surface_.reset();
  resize(w, h);
}

void Renderer::prepare_light() {
  const LightMethod method = options_.light_method;
  const bool compute = method == LightMethod::automatic ? !software_ : method == LightMethod::compute;
  light_.emplace(options_.light, compute);
  resolve_.emplace("resolve.frag", compute, GL_RGBA8);
}

bool Renderer::computes_spheres() const {
  if (options_.spheres != SphereMethod::automatic) return options_.spheres == SphereMethod::compute;
  constexpr std::int64_t many = 50'000;
  return !software_ && instances_.counts.bodies >= many;
}

void Renderer::set_scene(const FrameScene& scene) {
  scene_ = scene;
  bodies_.set_scene(scene);
  planes_.set_scene(scene);
  if (!scene.box) return;
  BoxInstance walls{};
  for (int axis = 0; axis < 3; ++axis) {
    walls.min[axis] = static_cast<float>(scene.box->min[axis]);
    walls.max[axis] = static_cast<float>(scene.box->max[axis]);
  }
  walls_.upload(&walls, sizeof walls);
}

void Renderer::set_marks(std::span<const BoxInstance> boxes) {
  mark_count_ = static_cast<std::int64_t>(boxes.size());
  last_mark_level_ = 0;
  for (const BoxInstance& box : boxes)
    last_mark_level_ = std::max(last_mark_level_, static_cast<int>(box.level));
  if (mark_count_ > 0) marks_.upload(boxes.data(), boxes.size_bytes());
}

void Renderer::bind_uniforms(const gl::Buffer& buffer) const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffer.get());
}

Renderer::Frame Renderer::frame_of(const OrbitCamera& camera, const FrameLayers& layers,
                                   const ValueRange& values) const {
  Frame frame;
  frame.layers = layers;
  frame.values = values;
  frame.camera =
      camera_uniforms(camera, scene_, surface_->width(), surface_->height(), options_.supersampling);
  frame.light = light_uniforms(scene_, light_->shadow_size());
  set_light(frame.camera, frame.light);
  set_values(frame.camera, values, layers.color == BodyColor::id);
  const int levels = static_cast<int>(instances_.level_sizes.size());
  const bool boxes = layers.boxes && levels > 0;
  frame.last_level = boxes ? layers.first_level + levels - 1 : last_mark_level_;
  set_levels(frame.camera, boxes ? layers.first_level : 0, frame.last_level);
  return frame;
}

void Renderer::bind(const Frame& frame) {
  camera_uniforms_.upload(&frame.camera, sizeof frame.camera);
  light_uniforms_.upload(&frame.light, sizeof frame.light);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);  // preserves the precision of reversed depth
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void Renderer::begin_surface(bool clear) {
  bind_uniforms(camera_uniforms_);
  surface_->bind();
  glDepthMask(GL_TRUE);
  const float nothing[4] = {};
  if (clear) {
    glClearNamedFramebufferfv(surface_->framebuffer(), GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(surface_->framebuffer(), GL_COLOR, 1, nothing);
    glClearNamedFramebufferfv(surface_->framebuffer(), GL_DEPTH, 0, nothing);
  }
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDisable(GL_BLEND);
}

void Renderer::draw(const OrbitCamera& camera, const FrameLayers& layers, const ValueRange& values,
                    gl::PassClock* clock) {
  const auto mark = [&](const char* pass) {
    if (clock) clock->mark(pass);
  };
  if (clock) clock->begin();
  sliced_.reset();
  const Frame frame = frame_of(camera, layers, values);
  bind(frame);
  const bool compute = computes_spheres();
  bind_uniforms(light_uniforms_);
  const gl::Target& shadows = light_->begin_shadows();
  if (layers.spheres) bodies_.draw(instances_, BodyPass::Output::shadow, colors_.get(), shadows, compute);
  mark("shadows");
  begin_surface(true);
  if (layers.spheres) bodies_.draw(instances_, BodyPass::Output::surface, colors_.get(), *surface_, compute);
  mark("bodies");
  light_and_layers(frame, mark);
}

void Renderer::begin_slices(const OrbitCamera& camera, const FrameLayers& layers, const ValueRange& values) {
  const std::int64_t per_part = sliced_ ? sliced_->per_part : Frame{}.per_part;
  sliced_ = frame_of(camera, layers, values);
  sliced_->per_part = per_part;
}

bool Renderer::draw_slice(double milliseconds) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto ms_since = [](Clock::time_point then) {
    return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
  };
  Frame& frame = *sliced_;
  const std::int64_t bodies = frame.layers.spheres ? instances_.counts.bodies : 0;
  bind(frame);
  // First all bodies into the shadow map, then all into the picture.
  const auto draw_part = [&] {
    const bool shadows = frame.drawn < bodies;
    const std::int64_t first = shadows ? frame.drawn : frame.drawn - bodies;
    if (shadows) {
      bind_uniforms(light_uniforms_);
      light_->begin_shadows(first == 0);
    } else {
      begin_surface(first == 0);
    }
    const std::int64_t count = std::min(frame.per_part, bodies - first);
    bodies_.draw_part(instances_, shadows ? BodyPass::Output::shadow : BodyPass::Output::surface,
                      colors_.get(), first, count);
    frame.drawn += count;
  };
  if (bodies == 0 && frame.drawn == 0) {
    bind_uniforms(light_uniforms_);
    light_->begin_shadows();
    begin_surface(true);
  }
  while (frame.drawn < 2 * bodies) {
    if (ms_since(start) >= milliseconds) return false;
    const Clock::time_point before = Clock::now();
    draw_part();
    finish();
    const double ms = ms_since(before);
    if (ms > milliseconds / 2) frame.per_part = std::max<std::int64_t>(frame.per_part / 2, 256);
    if (ms < milliseconds / 8) frame.per_part = std::min<std::int64_t>(2 * frame.per_part, 1 << 20);
  }
  begin_surface(false);
  light_and_layers(frame, [](const char*) {});
  finish();
  return true;
}

/// The rest of a picture, when the bodies are drawn.
void Renderer::light_and_layers(const Frame& frame, const std::function<void(const char*)>& mark) {
  const FrameLayers& layers = frame.layers;
  if (layers.grid) planes_.draw_surfaces();
  gl::check("draw the surfaces");
  mark("planes");

  light_->draw(*surface_, *lit_);
  mark("light");

  lit_->bind();
  if (layers.grid) planes_.draw_veils();
  if (layers.walls && scene_.box) lines_.draw_walls(walls_);
  if (layers.joints && instances_.counts.joints > 0)
    lines_.draw_joints(instances_.joints, instances_.counts.joints);
  mark("veils and walls");
  if (layers.boxes || layers.contacts) lines_.look_at(*surface_, options_.cull_lines);
  glBindTextureUnit(0, heat_.get());
  if (layers.boxes)
    lines_.draw_boxes(instances_.boxes, instances_.level_sizes, layers.first_level, frame.last_level,
                      box_colors(layers, frame.values), layers.highlighted_level);
  mark("boxes");
  if (layers.contacts) lines_.draw_contacts(instances_.contacts, instances_.counts.contacts);
  mark("contacts");
  if (layers.ghosts) ghosts_.draw_ghosts();
  if (layers.errors) ghosts_.draw_errors(frame.values.error_scale);
  if (mark_count_ > 0) lines_.draw_marks(marks_, mark_count_);

  resolve();
  previous_.reset();
  gl::check("draw a frame of " + std::to_string(width()) + "x" + std::to_string(height()));
  mark("resolve");
}

void Renderer::resolve() const {
  if (options_.supersampling == 1) {
    glBlitNamedFramebuffer(lit_->framebuffer(), picture_->framebuffer(), 0, 0, width(), height(), 0, 0,
                           width(), height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
    return;
  }
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glBindTextureUnit(0, lit_->color());
  resolve_->draw(*picture_);
}

Image Renderer::read_picture() const {
  Image image{width(), height(), {}};
  image.rgba.resize(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()) * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(picture_->color(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(image.rgba.size()),
                    image.rgba.data());
  gl::check("read the pixels of the frame");
  flip_rows(image.rgba, static_cast<std::size_t>(width()) * 4, height());
  return image;
}

void Renderer::finish() {
  glFinish();
  gl::check("complete the frame");
}

void Renderer::draw_id_target(const OrbitCamera& camera, const IdLayers& layers) {
  if (!ids_) ids_.emplace("ids", width(), height(), std::vector<GLenum>{GL_R32UI}, GL_DEPTH_COMPONENT32F);
  const FrameUniforms uniforms = camera_uniforms(camera, scene_, width(), height(), 1);
  camera_uniforms_.upload(&uniforms, sizeof uniforms);
  bind_uniforms(camera_uniforms_);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  ids_->bind();
  glDepthMask(GL_TRUE);
  const GLuint none[4] = {};
  const float farthest = 0;
  glClearNamedFramebufferuiv(ids_->framebuffer(), GL_COLOR, 0, none);
  glClearNamedFramebufferfv(ids_->framebuffer(), GL_DEPTH, 0, &farthest);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDisable(GL_BLEND);
  if (layers.bodies) bodies_.draw(instances_, BodyPass::Output::ids, colors_.get(), *ids_, false);
  if (layers.boxes)
    lines_.draw_box_ids(instances_.boxes, instances_.counts.boxes, layers.edges, layers.low, layers.high);
}

std::optional<std::uint32_t> Renderer::pick_box(const OrbitCamera& camera, IdLayers layers, int x, int y,
                                                int reach) {
  layers.boxes = layers.edges = true;
  draw_id_target(camera, layers);
  const int left = std::max(x - reach, 0), right = std::min(x + reach, width() - 1);
  const int top = std::max(y - reach, 0), bottom = std::min(y + reach, height() - 1);
  if (left > right || top > bottom) return std::nullopt;
  const int columns = right - left + 1, rows = bottom - top + 1;
  std::vector<std::uint32_t> ids(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTextureSubImage(ids_->color(), 0, left, height() - 1 - bottom, 0, columns, rows, 1, GL_RED_INTEGER,
                       GL_UNSIGNED_INT, static_cast<GLsizei>(ids.size() * sizeof ids[0]), ids.data());
  gl::check("read the ids near a pixel");
  std::optional<std::uint32_t> nearest;
  int least = reach * reach + 1;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t id = ids[static_cast<std::size_t>(row * columns + column)];
      const int dx = left + column - x, dy = bottom - row - y, away = dx * dx + dy * dy;
      if ((id & 0x80000000u) == 0 || away >= least) continue;
      least = away;
      nearest = id & 0x7fffffffu;
    }
  return nearest;
}

std::uint32_t Renderer::pick(const OrbitCamera& camera, const IdLayers& layers, int x, int y) {
  if (x < 0 || y < 0 || x >= width() || y >= height()) return 0;
  draw_id_target(camera, layers);
  std::uint32_t id = 0;
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTextureSubImage(ids_->color(), 0, x, height() - 1 - y, 0, 1, 1, 1, GL_RED_INTEGER, GL_UNSIGNED_INT,
                       sizeof id, &id);
  gl::check("read an id");
  return id;
}

std::vector<std::uint32_t> Renderer::draw_ids(const OrbitCamera& camera, const IdLayers& layers) {
  draw_id_target(camera, layers);
  std::vector<std::uint32_t> ids(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTextureImage(ids_->color(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                    static_cast<GLsizei>(ids.size() * sizeof ids[0]), ids.data());
  gl::check("read the ids");
  flip_rows(ids, static_cast<std::size_t>(width()), height());
  return ids;
}

}  // namespace collidoscope
