// Draws several volumes along one ray. Each has a march of its own; the one that is farthest behind advances, so that
// segments are added in the order in which they begin. Overlapping media hide each other by the product of what they
// let through. With iso-surfaces or slices a volume is drawn as a whole before those that begin behind it.
// A volume on the ray. Distances from the eye are t + anchor.w of the volume.
struct Track {
  Ray ray;
  vec2 rest;   // what is left of the volume and the stretch
  vec2 shown;  // the part of it that clip boxes leave, through which the march goes
  March march;
};

// Goes on with the next part that clip boxes leave.
void begin_part(inout Track track) {
#ifdef SURFCAST_CLIPPED
  track.shown = shown_part(track.ray, track.rest);
  track.rest.x = max(track.shown.y, track.rest.x + kNudge * track.ray.step);
#else
  track.shown = track.rest;
  track.rest.x = track.rest.y;
#endif
  track.march = march_from(track.shown.x);
}

bool ended(Track track) { return track.march.t >= track.shown.y && track.rest.x >= track.rest.y; }

// The volume `own_volume` between two distances from the eye.
Track track_of(vec2 pixel, vec2 distances) {
  Track track;
  track.ray = ray_through(pixel);
  track.rest = passage(track.ray.start, track.ray.inverse, volume.low.xyz, volume.high.xyz);
  track.rest = vec2(max(track.rest.x, distances.x - volume.anchor.w), min(track.rest.y, distances.y - volume.anchor.w));
  begin_part(track);
  return track;
}

// Adds the light of all volumes between two distances from the eye.
void draw_volumes(vec2 pixel, vec2 distances, inout Light light) {
  Track tracks[SURFCAST_VOLUMES];
  int count = volumes[0].clips.w;
  for (own_volume = 0; own_volume < count; ++own_volume) tracks[own_volume] = track_of(pixel, distances);
  while (light.transmittance > kClear) {
    int behind = -1;
    float least = kNever;
    for (int i = 0; i < count; ++i) {
      float at = tracks[i].march.t + volumes[i].anchor.w;
      if (ended(tracks[i]) || at >= least) continue;
      behind = i;
      least = at;
    }
    if (behind < 0) break;
    own_volume = behind;
    Track track = tracks[behind];
    if (track.march.t >= track.shown.y) {
      begin_part(track);
    } else {
#ifdef SURFCAST_SURFACES
      draw_stretch(track.ray, track.shown, light);
      track.march.t = track.shown.y;
#else
      advance(track.ray, track.shown.y, track.march, light);
#endif
    }
    tracks[behind] = track;
  }
  own_volume = 0;
}
