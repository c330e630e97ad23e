#include "crs/transformation.h"

#include <utility>

#include "crs/load_proj.h"

namespace surfcast::crs {

Transformation::Transformation(std::unique_ptr<Operation> operation) : operation_(std::move(operation)) {}
Transformation::Transformation(Transformation&&) noexcept = default;
Transformation& Transformation::operator=(Transformation&&) noexcept = default;
Transformation::~Transformation() = default;

Result<Transformation> Transformation::between(const CoordinateSystem& from, const CoordinateSystem& to,
                                               const geometry::Box& bounds) {
  return loaded_proj().find_operation(from, to, bounds).map([](Operation operation) {
    return Transformation(std::make_unique<Operation>(std::move(operation)));
  });
}

const std::string& Transformation::name() const {
  return operation_->name;
}

std::optional<double> Transformation::accuracy() const {
  return operation_->accuracy;
}

double Transformation::length_factor() const {
  return operation_->length_factor;
}

const glm::dmat3& Transformation::turn() const {
  return operation_->turn;
}

void Transformation::apply(std::span<glm::dvec3> positions) const {
  loaded_proj().apply(operation_->handle.get(), positions);
}

}  // namespace surfcast::crs
