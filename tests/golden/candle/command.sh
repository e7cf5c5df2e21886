for s in $(seq 1 64); do
  sample-surface --seed $s --samples 500k --environment 0.006,0.008,0.013 data/scenes/candle.glb -o $s.cloud
  gather --seed $s --spp 12 --width 48 --height 48 --bssrdf directional-dipole --medium data/media/candle_wax.json --environment 0.006,0.008,0.013 --view data/views/candle/side.json $s.cloud data/scenes/candle.glb -o candle/$s.exr
done
compare --summarise candle tests/golden/candle
