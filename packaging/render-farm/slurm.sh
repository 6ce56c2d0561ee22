#!/usr/bin/env bash
# A job array of Slurm: renders a video in parts on the cluster's nodes, then joins the parts.
#
#   SONG=song.flac OUTPUT=song.mp4 FLAGS="--show auto --size 3840x2160" packaging/render-farm/slurm.sh 32
#
# renders 32 parts. All nodes need the program and see the same folder. A part that fails can be submitted again: it
# continues after its last complete piece.
set -euo pipefail

: "${SONG:?set SONG to the song}" "${OUTPUT:?set OUTPUT to the video}"
export SONG OUTPUT
export FLAGS=${FLAGS:-} MARIANA=${MARIANA:-mariana}
ending=${OUTPUT##*.}
export PART=${OUTPUT%.*}-part ending

# Inside a task of the array.
if [[ -n ${SLURM_ARRAY_TASK_ID:-} ]]; then
    # The flags are several words.
    # shellcheck disable=SC2086
    exec "$MARIANA" video "$SONG" -o "$PART-$SLURM_ARRAY_TASK_ID.$ending" --flash-limiter off \
        --part "$SLURM_ARRAY_TASK_ID/$PARTS" $FLAGS
fi

export PARTS=${1:?give the number of parts}
array=$(sbatch --parsable --array="1-$PARTS" --job-name=mariana-parts "$0")
files=()
for ((number = 1; number <= PARTS; number++)); do files+=("$PART-$number.$ending"); done
# If a part fails, the video is not joined.
sbatch --dependency="afterok:$array" --kill-on-invalid-dep=yes --job-name=mariana-join \
    --wrap="$(printf '%q ' "$MARIANA" video "$SONG" -o "$OUTPUT" --join "${files[@]}")"
