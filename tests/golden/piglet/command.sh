for s in $(seq 1 64); do
  sample-surface --seed $s --samples 200k --environment 0.08,0.09,0.11 data/scenes/piglet.glb -o $s.cloud
  gather --seed $s --spp 24 --width 48 --height 48 --bssrdf directional-dipole --medium data/media/skin2.json --environment 0.08,0.09,0.11 --view data/views/piglet/face.json $s.cloud data/scenes/piglet.glb -o piglet/$s.exr
done
compare --summarise piglet tests/golden/piglet
