# The pictures of docs/gallery.md: read by `./dev gallery`, whose `shot NAME OPTION...` draws one of them.
for name in straight wavy curly ponytail; do shot "head-$name" --scene "$name" --azimuth 50; done
close=(--scene wavy --strands 200 --zoom 2.2 --azimuth 60)
for name in multi single combined; do shot "interpolation-$name" "${close[@]}" --interpolation "$name"; done
shot profile-even "${close[@]}" --interpolation single --clump-radius 0.006 --lock-profile 1 1 1
shot profile-closing "${close[@]}" --interpolation single --clump-radius 0.006 --lock-profile 1 0.6 0
shot curls-none --scene straight --zoom 2.2 --azimuth 60
shot curls-tight --scene straight --zoom 2.2 --azimuth 60 --curl-radius 0.004 --curl-pitch 0.03 --segments 96
shot curls-loose --scene straight --zoom 2.2 --azimuth 60 --curl-radius 0.008 --curl-pitch 0.09 --segments 64
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
fine=(--scene wavy --hair-width 0.00012 --hairs 20000)
shot detail-near-full "${fine[@]}" --zoom 1.6 --detail 1 --longest-segment 0
shot detail-near "${fine[@]}" --zoom 1.6
shot detail-far-full "${fine[@]}" --zoom 0.4 --detail 1 --longest-segment 0
shot detail-far "${fine[@]}" --zoom 0.4
shot detail-tenth "${fine[@]}" --zoom 1.6 --detail 0.1
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
    --body-contact spheres --strands 3000 --azimuth 200 --hairs 60000 --hair-width 0.002
  shot real-curls --groom "$data/curls/frame_00.obj" --unit-meters 0.01
else
  say "no real grooms in $data (STRANDCAST_DATA): their four pictures are left out"
fi
