#include "service/local_queries.h"

#include <utility>

#include "model/fit_model.h"
#include "model/hidden_members.h"
#include "pick/pick_surfel.h"
#include "pick/source_blocks.h"
#include "render/display_options.h"
#include "service/local_point_stream.h"
#include "service/sights.h"

namespace surfcast::service {
namespace {

geometry::Camera camera_of(const model::ModelFile& model, const picture::PictureRequest& request, bool up_from_model) {
  if (!request.camera) return model::fit_model(model, static_cast<double>(request.width) / request.height);
  geometry::Camera camera = *request.camera;
  if (up_from_model) camera.view_up = model.info().up();
  return camera;
}

/// How surfels are seen through. As in the picture, but for X-rays of surfaces, whose opacities depend on the angle.
void set_transparency(const model::ModelFile& model, const picture::PictureRequest& request, kinds::PickQuery& query) {
  const render::SeenThrough through = render::seen_through(model.info(), request);
  query.transparent = through.any;
  query.by_file = through.by_file;
  if (through.ghosts) query.ghost = request.ghost;
  if (!through.by_class) return;
  query.class_opacities.assign(256, 1);
  for (const picture::ClassOpacity& of : request.class_opacities) query.class_opacities[of.code] = of.opacity;
}

}  // namespace

Result<kinds::PickQuery> query_of(const model::ModelFile& model, const SurfaceQuery& picture) {
  const auto& [request, up_from_model] = picture;
  const Result<geometry::CameraFrame> frame =
      geometry::make_camera_frame(camera_of(model, request, up_from_model), request.width, request.height);
  if (!frame) return fail(frame);
  kinds::PickQuery query{*frame, glm::dvec2(0), request.clip, request.hidden_classes};
  query.opacity = request.opacity;
  query.hidden_members = model::hidden_members(model, request.hidden_models);
  set_transparency(model, request, query);
  if (!model.volumes().empty()) {
    query.volumes = std::make_shared<const std::vector<kinds::VolumeSight>>(volume_sights(model, request));
  }
  if (!model.ellipsoid_sources().empty()) {
    GlyphSights sights = glyph_sights(model, request);
    query.glyphs = std::make_shared<const std::vector<kinds::GlyphSight>>(std::move(sights.sights));
    query.reach = sights.reach;
  }
  return query;
}

namespace {

class LocalQueries : public ModelQueries {
 public:
  LocalQueries(size_t block_bytes, kinds::KindTable kinds)
      : blocks_(block_bytes, kinds), searched_blocks_(block_bytes, kinds) {}

  Result<std::optional<kinds::PickedSurfel>> pick(const ModelPointer& model, const PixelQuery& pixel,
                                                  const std::atomic<bool>& cancelled) override {
    Result<kinds::PickQuery> query = query_of(*model, pixel.picture);
    if (!query) return fail(query);
    query->pixel = {pixel.x + 0.5, pixel.y + 0.5};
    return pick::pick_surfel(*model, *query, blocks_, cancelled, pixel.most_blocks);
  }

  Result<std::vector<pick::FrontPixel>> front_surface(const ModelPointer& model, const SurfaceQuery& picture,
                                                      const std::atomic<bool>& cancelled) override {
    const Result<kinds::PickQuery> query = query_of(*model, picture);
    if (!query) return fail(query);
    return pick::find_front_surface(*model, *query, searched_blocks_, cancelled);
  }

  Result<pick::Band> band(const ModelPointer& model, const pick::BandQuery& query,
                          const std::atomic<bool>& cancelled) override {
    return pick::find_band(*model, query, cancelled);
  }

  Result<std::unique_ptr<PointStream>> points(const ModelPointer& model, const PointsQuery& query,
                                              std::shared_ptr<const std::atomic<bool>> cancelled) override {
    return LocalPointStream::open(model, query, std::move(cancelled));
  }

 private:
  pick::SourceBlocks blocks_;
  pick::SourceBlocks searched_blocks_;
};

}  // namespace

std::unique_ptr<ModelQueries> local_queries(size_t block_bytes, kinds::KindTable kinds) {
  return std::make_unique<LocalQueries>(block_bytes, kinds);
}

}  // namespace surfcast::service
