#!/bin/sh
# Makes three.iife.min.js and three.LICENSE beside it, and their lines of SHA256; needs Node and npm. The results are
# committed: neither users nor the tests need Node. The same versions give the same bytes.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{"private": true}' > package.json
npm install --no-save --no-audit --no-fund --silent three@0.187.0 esbuild@0.28.2
cp "$here/three.js" .
npx esbuild three.js --bundle --minify --format=iife --global-name=THREE --target=es2022 --legal-comments=inline \
  --outfile="$here/three.iife.min.js"
cp node_modules/three/LICENSE "$here/three.LICENSE"
cd "$here"
grep -v ' three\.' SHA256 > "$work/SHA256"
sha256sum three.LICENSE three.iife.min.js >> "$work/SHA256"
cp "$work/SHA256" SHA256
