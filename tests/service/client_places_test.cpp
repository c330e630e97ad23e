#include "service/client_places.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

using Place = std::shared_ptr<const void>;

/// As many places as a client gets.
std::vector<Place> all_of(ClientPlaces& places, ClientId client) {
  std::vector<Place> taken;
  for (Place place = places.take(client); place; place = places.take(client)) taken.push_back(std::move(place));
  return taken;
}

TEST(ClientPlacesTest, NoClientTakesThemAll) {
  ClientPlaces places(16);
  const std::vector<Place> first = all_of(places, 1);
  const std::vector<Place> second = all_of(places, 2);
  const std::vector<Place> third = all_of(places, 3);
  EXPECT_EQ(first.size(), 8U);
  EXPECT_EQ(second.size(), 4U);
  EXPECT_EQ(third.size(), 2U);
}

TEST(ClientPlacesTest, OnePlaceIsForWhoeverComesFirst) {
  ClientPlaces places(1);
  const Place place = places.take(1);
  EXPECT_TRUE(place);
  EXPECT_FALSE(places.take(1));
  EXPECT_FALSE(places.take(2));
}

TEST(ClientPlacesTest, APlaceIsFreeWithItsLastCopy) {
  ClientPlaces places(1);
  Place place = places.take(1);
  Place copy = place;
  place.reset();
  EXPECT_FALSE(places.take(2));
  copy.reset();
  EXPECT_TRUE(places.take(2));
}

TEST(ClientPlacesTest, APlaceMayOutliveTheOthers) {
  Place place;
  {
    ClientPlaces places(2);
    place = places.take(1);
  }
  EXPECT_TRUE(place);
}

}  // namespace
}  // namespace surfcast::service
