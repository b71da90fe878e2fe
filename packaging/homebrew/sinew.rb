# Built from the package on crates.io. `packaging/lint --digest` prints the checksum of a release.
class Sinew < Formula
  desc "Estimate the elongation of rope tendons of robots from their encoders"
  homepage "https://docs.rs/sinew"
  url "https://static.crates.io/crates/sinew/sinew-0.1.0.crate"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license any_of: ["MIT", "Apache-2.0"]

  depends_on "rust" => :build

  def install
    system "tar", "--strip-components", "1", "-xzf", "sinew-#{version}.crate"
    system "cargo", "install", "--features", "png,sheets,db3", *std_cargo_args
    generate_completions_from_executable(bin/"sinew", "completions")
    system bin/"sinew", "man", "--out", man1
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/sinew --version")
    assert_match "liros-dc000-0301", shell_output("#{bin}/sinew rope list")
  end
end
