# The pictures of docs/gallery.md: read by `./dev gallery`, whose `shot NAME OPTION...` draws one of them.
for name in straight wavy curly ponytail; do shot "head-$name" --scene "$name" --azimuth 50; done
close=(--scene wavy --strands 200 --zoom 2.2 --azimuth 60)
for name in multi single combined; do shot "interpolation-$name" "${close[@]}" --interpolation "$name"; done
shot profile-even "${close[@]}" --interpolation single --clump-radius 0.006 --lock-profile 1 1 1
shot profile-closing "${close[@]}" --interpolation single --clump-radius 0.006 --lock-profile 1 0.6 0
shot curls-none --scene straight --zoom 2.2 --azimuth 60
shot curls-tight --scene straight --zoom 2.2 --azimuth 60 --curl-radius 0.004 --curl-pitch 0.03 --segments 96
shot curls-loose --scene straight --zoom 2.2 --azimuth 60 --curl-radius 0.008 --curl-pitch 0.09 --segments 64
# A strand that waves in one plane, and then turns.
awk 'BEGIN { for (i = 0; i < 160; i++) { a = i * 0.2; w = 6 * (1 - exp(-i / 30)); flat = i < 80 ? 0.15 : 1
    print "v", w * sin(a), -i, flat * w * cos(a) }
  printf "l"; for (i = 1; i <= 160; i++) printf " %d", i; print "" }' >gallery/example.obj
locks=(--scene straight --strands 200 --interpolation single --zoom 2.2 --azimuth 60)
shot curls-example "${locks[@]}" --segments 128 --curl-example gallery/example.obj
stray=(--scene straight --zoom 3 --azimuth 100 --elevation -5)
shot deviations-none "${stray[@]}" --tip-deviation 0 --whole-deviation 0
shot deviations-tip "${stray[@]}" --tip-deviation 0.02 --whole-deviation 0
shot deviations-whole "${stray[@]}" --tip-deviation 0 --whole-deviation 0.01
shot deviations-both "${stray[@]}" --tip-deviation 0.02 --whole-deviation 0.01
sparse=(--scene straight --strands 150 --interpolation multi --zoom 2 --azimuth 200 --elevation 50)
shot bodies-let-in "${sparse[@]}"
shot bodies-kept-out "${sparse[@]}" --keep-out on
shot bodies-let-in-marked "${sparse[@]}" --hairs 4000 --mark-inside on
shot bodies-kept-out-marked "${sparse[@]}" --hairs 4000 --keep-out on --mark-inside on
shot marks-guides "${sparse[@]}" --hairs 4000 --mark-guides on
shot marks-tangents "${sparse[@]}" --hairs 4000 --mark-tangents on
shot marks-collided "${sparse[@]}" --hairs 4000 --mark-collided on
meet=(--scene straight --strands 400 --motion still --zoom 1.4 --azimuth 30 --keep-out on --skip 2)
shot colliders-none "${meet[@]}"
build/release/apps/strandcastd --scene straight --strands 400 --motion still --domain 79 --quiet >/dev/null &
daemon=$!
trap 'kill $daemon 2>/dev/null || true' EXIT
build/release/apps/strandcast ctl --domain 79 collider add ball sphere 0.13 -0.06 0.02 0.06 >/dev/null
shot colliders-cast --domain 79 --zoom 1.4 --azimuth 30 --keep-out on --skip 2
build/release/apps/strandcast ctl --domain 79 stop >/dev/null
wait $daemon || true
trap - EXIT
build/release/apps/strandcastd --config docs/hair_drier.toml --domain 79 --quiet >/dev/null &
daemon=$!
trap 'kill $daemon 2>/dev/null || true' EXIT
shot hair-drier --domain 79 --zoom 1 --azimuth 0 --skip 2.5
build/release/apps/strandcast ctl --domain 79 stop >/dev/null
wait $daemon || true
trap - EXIT
lit=(--scene curly --zoom 2.5 --azimuth 100)
shot shadows-off "${lit[@]}" --shadows off
for name in 3 7 15; do shot "shadows-$name-layers" "${lit[@]}" --shadow-layers "$name"; done
for name in constant linear power-of-two fibonacci; do
  shot "layers-$name" "${lit[@]}" --shadow-layers 3 --layer-sizes "$name"
done
for name in ignore last reach; do
  shot "beyond-$name" "${lit[@]}" --shadow-layers 3 --shadow-depth 0.02 --beyond-layers "$name"
done
shot filter-none "${lit[@]}" --shadow-map 128
shot filter-wide "${lit[@]}" --shadow-map 128 --shadow-filter 2
lamp=(--scene curly --azimuth 40 --light-position 0.35 0.25 0.45)
shot light-sun --scene curly --azimuth 40
shot light-point "${lamp[@]}" --light point --light-intensity 0.35
shot light-point-near --scene curly --azimuth 40 --light point --light-position 0.22 0 0.2 --light-intensity 0.07
spot=("${lamp[@]}" --light spot --light-intensity 0.5 --light-direction -0.6 -0.5 -0.8)
shot light-spot "${spot[@]}" --light-cone 16 --light-edge 0.4
shot light-spot-sharp "${spot[@]}" --light-cone 10 --light-edge 0
shot light-spot-shadow --scene straight --zoom 0.75 --azimuth -40 --elevation 30 --light spot \
  --light-position 0.9 1 1 --light-direction -0.7 -1 -0.8 --light-intensity 2.5 --light-cone 20
above=(--light-intensity 3.5 --light-cone 22)
shot light-three --scene straight --zoom 0.75 --azimuth 20 --elevation 30 \
  --light spot --light-position 1.1 1 0.9 --light-direction -0.9 -1 -0.75 --light-color 1 0.15 0.05 "${above[@]}" \
  --light spot --light-position -1.1 1 0.9 --light-direction 0.9 -1 -0.75 --light-color 0.05 0.8 0.15 "${above[@]}" \
  --light spot --light-position 0 1 -1.4 --light-direction 0 -0.9 1 --light-color 0.1 0.25 1 "${above[@]}"
fine=(--scene wavy --hair-width 0.00012 --hairs 20000)
shot detail-near-full "${fine[@]}" --zoom 1.6 --detail 1 --longest-segment 0
shot detail-near "${fine[@]}" --zoom 1.6
shot detail-far-full "${fine[@]}" --zoom 0.4 --detail 1 --longest-segment 0
shot detail-far "${fine[@]}" --zoom 0.4
shot detail-tenth "${fine[@]}" --zoom 1.6 --detail 0.1
for name in off on; do shot "culling-$name" "${fine[@]}" --zoom 6 --azimuth 80 --cull "$name"; done
for name in 0 1; do
  shot "hysteresis-$name" "${fine[@]}" --zoom 1.6 --finest-hair 1.5 --detail-hysteresis "$name"
done
# A map of the scalp, eight pixels wide: white over the right half of the head, nearly black over the left.
base64 -d >gallery/half.png <<'MAP'
iVBORw0KGgoAAAANSUhEUgAAAAgAAAABCAAAAADGa7CfAAAAEUlEQVQI12P8z8DAIMjAwAAACE4BEooiiUEAAAAASUVORK5CYII=
MAP
mapped=(--scene straight --motion still --zoom 1.6 --azimuth 0 --elevation 15 --hairs 20000 --hair-width 0.0002)
for name in density thickness; do shot "map-$name" "${mapped[@]}" "--$name-map" gallery/half.png; done
shot map-importance-none "${mapped[@]}" --detail 0.12
shot map-importance "${mapped[@]}" --detail 0.12 --importance-map gallery/half.png
thick=(--scene wavy --hairs 1500 --hair-width 0.001 --zoom 5 --azimuth 60)
for name in lines strips; do shot "geometry-$name" "${thick[@]}" --geometry "$name"; done
thin=(--scene wavy --hair-width 0.00012 --hairs 20000 --zoom 2.5)
for name in vertex fragment; do
  shot "shading-$name" --scene wavy --zoom 4 --azimuth 60 --hair-width 0.0006 --hairs 4000 --segments 10 \
    --longest-segment 0 --shading "$name"
done
for name in 1 2 4 8; do shot "samples-$name" "${thin[@]}" --samples "$name"; done
shot coverage-alpha "${thin[@]}" --samples 8 --coverage alpha
for name in box mitchell; do shot "still-$name" "${thin[@]}" --supersampling 2 --filter "$name"; done
if [ -d "$data" ]; then
  tails=$data/ponytail
  shot real-ponytail --groom "$tails/tail.tfx,$tails/side.tfx,$tails/front_top.tfx,$tails/back.tfx" \
    --body "$tails/ponytail_body.obj" --unit-meters 0.0025 --body-contact spheres --strands 1500 --azimuth 60
  shot real-sintel --groom "$data/sintel/sintel_hair_16pts.tfx" --body "$data/sintel/sintel.obj" \
    --body-contact spheres --strands 1500
  shot real-bear --groom "$data/bear/bear.tfx" --body "$data/bear/bear_body.obj" --unit-meters 0.01 \
    --body-contact spheres --strands 3000 --azimuth 200 --hairs 60000 --hair-width 0.002 --body-color 0.16 0.1 0.07
  shot curls-example-real "${locks[@]}" --segments 192 --curl-example "$data/curls/frame_00.obj" --curl-strand 40
  shot real-curls --groom "$data/curls/frame_00.obj" --unit-meters 0.01
else
  say "no real grooms in $data (STRANDCAST_DATA): their pictures are left out"
fi
