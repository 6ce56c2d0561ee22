cask "mariana" do
  version "@VERSION@"
  sha256 "@DMG_SUM@"

  url "@DOWNLOADS@/@DMG@"
  name "Mariana"
  desc "@SUMMARY@"
  homepage "@HOMEPAGE@"

  depends_on arch: :arm64
  depends_on macos: ">= :big_sur"

  app "Mariana.app"
  binary "#{appdir}/Mariana.app/Contents/MacOS/mariana"

  zap trash: [
    "~/Library/Application Support/mariana",
    "~/Library/Caches/mariana",
  ]
end
