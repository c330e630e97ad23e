#include "builder/model_output.h"

#include "base/contract.h"

namespace surfcast::builder {

Result<model::ModelWriter*> ModelOutput::writer(model::ModelSchema schema) {
  if (writer_) {
    writer_->add_schema(schema);
    return &*writer_;
  }
  Result<model::ModelWriter> created = model::ModelWriter::create(target_, std::move(schema));
  if (!created) return fail(created);
  writer_.emplace(std::move(*created));
  return &*writer_;
}

Result<model::WriteReport> ModelOutput::finish() {
  SURFCAST_EXPECTS(writer_.has_value());
  return writer_->finish();
}

}  // namespace surfcast::builder
